// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/slam2d/back_end/keyframe.hpp"
#include "modules/slam2d/matching/point_map.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// The map of some consecutive keyframes, few enough that drift among them does not matter. Its
/// frame is that of its first keyframe: when the pose graph moves the submap, its points stay.
struct Submap {
  Submap(std::size_t first, const geometry::SE2& pose, const MapParams& params)
      : first_keyframe(first), T_map_submap(pose), points(params) {}

  /// Adds the keyframe after the last one: its pose, and its points to the map.
  void add(const geometry::SE2& T_submap_base, std::span<const OrientedPoint> points_base);

  [[nodiscard]] std::size_t end_keyframe() const {
    return first_keyframe + T_submap_keyframe.size();
  }
  [[nodiscard]] bool has(std::size_t keyframe) const {
    return keyframe >= first_keyframe && keyframe < end_keyframe();
  }
  [[nodiscard]] const geometry::SE2& pose_of(std::size_t keyframe) const {
    return T_submap_keyframe[keyframe - first_keyframe];
  }

  std::size_t first_keyframe;  ///< the others follow without a gap
  geometry::SE2 T_map_submap;
  std::vector<geometry::SE2> T_submap_keyframe;
  PointMap points;
};

/// A submap, and the distance of the nearest of its keyframes.
struct NearbySubmap {
  double distance_m = 0.0;
  std::size_t submap = 0;
  auto operator<=>(const NearbySubmap&) const = default;  // NOLINT: clang-tidy 14 sees a null here
};

/// The submaps before `end_submap` that have a keyframe within `distance_m` of a place, the nearest
/// first. Successive submaps overlap and show the same, so only every second one is considered.
[[nodiscard]] std::vector<NearbySubmap> nearest_submaps(std::span<const Submap> submaps,
                                                        std::span<const Keyframe> keyframes,
                                                        const Eigen::Vector2d& p_map,
                                                        double distance_m, std::size_t end_submap);

/// The oldest submap near the newest keyframe that newer keyframes replace: each of its keyframes
/// has at least `num_newer` newer ones within 0.75 m and 30 degrees. Only submaps before
/// `end_submap` are considered.
[[nodiscard]] std::optional<std::size_t> oldest_replaced_submap(std::span<const Submap> submaps,
                                                                std::span<const Keyframe> keyframes,
                                                                std::size_t end_submap,
                                                                int num_newer);

}  // namespace nodmap::slam2d
