// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model/replaced_keyframe.hpp"

#include "common/geometry/angle.hpp"
#include "common/geometry/pose_tolerance.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

constexpr geometry::PoseTolerance kSameView{.distance_m = 0.75,
                                            .rotation_rad = geometry::deg_to_rad(30.0)};

}  // namespace

bool shows_the_same(const SE3& a, const SE3& b) {
  return geometry::is_within(a, b, kSameView);
}

namespace {

// The first of the newer keyframes that replace keyframe k, or none if there are fewer than
// `num_newer`.
std::optional<std::size_t> first_in_place_of(std::size_t k, std::span<const SE3> T_map_keyframes,
                                             const std::vector<bool>& is_in_map, int num_newer) {
  std::optional<std::size_t> first;
  int found = 0;
  for (std::size_t newer = k + 1; newer < T_map_keyframes.size() && found < num_newer; ++newer) {
    if (is_in_map[newer] == is_in_map[k] &&
        shows_the_same(T_map_keyframes[newer], T_map_keyframes[k])) {
      first = first.value_or(newer);
      ++found;
    }
  }
  return found >= num_newer ? first : std::nullopt;
}

}  // namespace

std::optional<ReplacedKeyframe> oldest_replaced_keyframe(std::span<const SE3> T_map_keyframes,
                                                         const std::vector<bool>& is_in_map,
                                                         int num_newer) {
  for (std::size_t k = 1; k + 1 < T_map_keyframes.size(); ++k) {
    if (!shows_the_same(T_map_keyframes[k], T_map_keyframes.back())) {
      continue;
    }
    if (const auto newer = first_in_place_of(k, T_map_keyframes, is_in_map, num_newer)) {
      return ReplacedKeyframe{.index = k, .by = *newer};
    }
  }
  return std::nullopt;
}

}  // namespace nodmap::slam6d
