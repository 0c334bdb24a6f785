// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace nodmap::slam2d {

/// A rectangle of the map whose sides are parallel to its axes: two opposite corners in map, m.
struct Region {
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  Eigen::Vector2d high = Eigen::Vector2d::Zero();
};

/// Whether the corners are finite and the area is positive.
[[nodiscard]] inline bool is_plausible(const Region& region) {
  return region.low.allFinite() && region.high.allFinite() &&
         (region.low.array() < region.high.array()).all();
}

/// Whether `inner` lies inside `outer`; its sides may be the same.
[[nodiscard]] inline bool contains(const Region& outer, const Region& inner) {
  return (outer.low.array() <= inner.low.array()).all() &&
         (inner.high.array() <= outer.high.array()).all();
}

/// A region that was cleared on request: keyframes from before the request no longer draw in it.
struct ClearedRegion {
  Region region;
  std::size_t num_keyframes = 0;  ///< the keyframes before this index
};

}  // namespace nodmap::slam2d
