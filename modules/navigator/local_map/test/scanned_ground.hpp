// SPDX-License-Identifier: BSD-3-Clause
// For tests: ground with boxes and pits, and the scans an ideal nodding laser makes of it.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "common/scan/scan.hpp"
#include "modules/navigator/local_map/local_map.hpp"
#include "modules/navigator/test/kurt_scan.hpp"

namespace nodmap::navigator::test {

/// A box along the axes of odom that stands on the floor; a pit if `height_m` is negative.
struct Block {
  Eigen::Vector2d min;
  Eigen::Vector2d max;
  double height_m = 0.0;

  [[nodiscard]] bool covers(const Eigen::Vector2d& p) const {
    return (p.array() > min.array()).all() && (p.array() < max.array()).all();
  }
};

struct Ground {
  std::vector<Block> blocks;
  /// From this x on the floor rises by `slope` m/m, towards +x; falls if it is negative.
  double ramp_from_x_m = 0.0;
  double slope = 0.0;

  /// Oracle: height at a place, by the definition.
  [[nodiscard]] double height_m(const Eigen::Vector2d& p) const {
    double height = slope * std::max(0.0, p.x() - ramp_from_x_m);
    for (const Block& block : blocks) {
      height = block.covers(p) ? block.height_m : height;
    }
    return height;
  }

  /// Range to the surface, found in steps of 1 mm; +infinity beyond 8 m or lower than 2 m below the
  /// floor.
  [[nodiscard]] double range_m(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) const {
    for (double range = 0.1; range < 8.0; range += 0.001) {
      const Eigen::Vector3d p = origin + range * ray;
      if (p.z() < -2.0) {
        break;
      }
      if (p.z() <= height_m(p.head<2>())) {
        return range;
      }
    }
    return std::numeric_limits<double>::infinity();
  }
};

/// A scan of 181 beams from the pitch axis of KURT3D.
inline scan::Scan scan_of(const Ground& ground, const geometry::SE2& T_odom_base,
                          double pitch_rad) {
  scan::Scan scan = kurt_scan(geometry::to_se3(T_odom_base), pitch_rad,
                              [&ground](const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
                                return ground.range_m(origin, ray);
                              });
  scan.duration = 6660us;
  return scan;
}

/// Adds the scans of one sweep, from below to above level, to a local map or a navigator.
template <class Map>
void sweep(Map& map, const Ground& ground, const geometry::SE2& T_odom_base = {},
           double step_deg = 3.0) {
  for (double deg = -60.0; deg <= 2.0; deg += step_deg) {
    map.add_scan(scan_of(ground, T_odom_base, geometry::deg_to_rad(deg)), T_odom_base);
  }
}

/// The same in four directions, a quarter apart, beginning with that of the pose.
template <class Map>
void look_around(Map& map, const Ground& ground, const geometry::SE2& T_odom_base = {}) {
  for (int quarter = 0; quarter < 4; ++quarter) {
    geometry::SE2 T_odom_turned = T_odom_base;
    T_odom_turned.yaw += 0.5 * geometry::kPi * quarter;
    sweep(map, ground, T_odom_turned);
  }
}

/// A square fence of 2.2 m around the origin, with a gap ahead.
inline Ground fence(double gap_m = 0.0) {
  Ground ground{{{{-1.1, -1.1}, {-1.0, 1.1}, 0.5},
                 {{-1.1, 1.0}, {1.1, 1.1}, 0.5},
                 {{-1.1, -1.1}, {1.1, -1.0}, 0.5}}};
  if (gap_m == 0.0) {
    ground.blocks.push_back({{1.0, -1.1}, {1.1, 1.1}, 0.5});
  } else {
    ground.blocks.push_back({{1.0, -1.1}, {1.1, -0.5 * gap_m}, 0.5});
    ground.blocks.push_back({{1.0, 0.5 * gap_m}, {1.1, 1.1}, 0.5});
  }
  return ground;
}

/// Whether a place is blocked by an obstacle or a hole, or as the edge of a hole.
inline bool is_blocked_at(const LocalMap& map, const Eigen::Vector2d& p_odom) {
  const LocalView view = map.view_around(p_odom, map.grid().cell_size_m());
  return (view.at(map.grid().index_of(p_odom)) & LocalView::kBlocked) != 0U;
}

}  // namespace nodmap::navigator::test
