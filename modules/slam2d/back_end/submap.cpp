// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/submap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/pose_tolerance.hpp"

namespace nodmap::slam2d {
namespace {

// Within this distance and rotation, scans show nearly the same.
constexpr geometry::PoseTolerance kSameView{.distance_m = 0.75,
                                            .rotation_rad = geometry::deg_to_rad(30.0)};

bool shows_the_same(const geometry::SE2& a, const geometry::SE2& b) {
  return geometry::is_within(a, b, kSameView);
}

// Whether a keyframe has at least `num_newer` newer ones at its place.
bool is_replaced(std::span<const Keyframe> keyframes, std::size_t keyframe, int num_newer) {
  int found = 0;
  for (std::size_t k = keyframes.size(); k-- > keyframe + 1 && found < num_newer;) {
    found += shows_the_same(keyframes[k].T_map_base, keyframes[keyframe].T_map_base) ? 1 : 0;
  }
  return found >= num_newer;
}

}  // namespace

void Submap::add(const geometry::SE2& T_submap_base, std::span<const OrientedPoint> points_base) {
  points.insert(transformed(T_submap_base, points_base));
  T_submap_keyframe.push_back(T_submap_base);
}

std::vector<NearbySubmap> nearest_submaps(std::span<const Submap> submaps,
                                          std::span<const Keyframe> keyframes,
                                          const Eigen::Vector2d& p_map, double distance_m,
                                          std::size_t end_submap) {
  std::vector<NearbySubmap> found;
  std::size_t end_keyframe = 0;
  for (std::size_t s = 0; s < end_submap; ++s) {
    if (submaps[s].first_keyframe < end_keyframe) {
      continue;
    }
    end_keyframe = submaps[s].end_keyframe();
    double nearest_m2 = std::numeric_limits<double>::infinity();
    for (std::size_t k = submaps[s].first_keyframe; k < submaps[s].end_keyframe(); ++k) {
      nearest_m2 =
          std::min(nearest_m2, (keyframes[k].T_map_base.translation() - p_map).squaredNorm());
    }
    if (nearest_m2 < distance_m * distance_m) {
      found.push_back({std::sqrt(nearest_m2), s});
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::optional<std::size_t> oldest_replaced_submap(std::span<const Submap> submaps,
                                                  std::span<const Keyframe> keyframes,
                                                  std::size_t end_submap, int num_newer) {
  constexpr double kNearM = 10.0;
  const Eigen::Vector2d here = keyframes.back().T_map_base.translation();
  for (std::size_t s = 0; s < end_submap; ++s) {
    std::size_t k = submaps[s].first_keyframe;
    if ((keyframes[k].T_map_base.translation() - here).norm() > kNearM) {
      continue;  // nothing has changed there
    }
    while (k < submaps[s].end_keyframe() && is_replaced(keyframes, k, num_newer)) {
      ++k;
    }
    if (k == submaps[s].end_keyframe()) {
      return s;
    }
  }
  return std::nullopt;
}

}  // namespace nodmap::slam2d
