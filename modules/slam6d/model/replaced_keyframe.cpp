// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model/replaced_keyframe.hpp"

#include "common/geometry/angle.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

constexpr double kOnePlaceM = 0.75;
constexpr double kOnePlaceRad = geometry::deg_to_rad(30.0);

}  // namespace

bool is_same_place(const SE3& a, const SE3& b) {
  return (a.translation() - b.translation()).squaredNorm() <= kOnePlaceM * kOnePlaceM &&
         geometry::rotation_rad(a, b) <= kOnePlaceRad;
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
        is_same_place(T_map_keyframes[newer], T_map_keyframes[k])) {
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
    if (!is_same_place(T_map_keyframes[k], T_map_keyframes.back())) {
      continue;
    }
    if (const auto newer = first_in_place_of(k, T_map_keyframes, is_in_map, num_newer)) {
      return ReplacedKeyframe{.index = k, .by = *newer};
    }
  }
  return std::nullopt;
}

}  // namespace nodmap::slam6d
