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

/// Whether it is one: finite, and with an area.
[[nodiscard]] inline bool is_plausible(const Region& region) {
  return region.low.allFinite() && region.high.allFinite() &&
         (region.low.array() < region.high.array()).all();
}

/// A region that somebody has cleared: what the keyframes until then saw there counts no more.
struct ClearedRegion {
  Region region;
  std::size_t num_keyframes = 0;  ///< the keyframes before this index
};

}  // namespace nodmap::slam2d
