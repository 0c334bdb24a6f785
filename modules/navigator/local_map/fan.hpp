// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/scan/scan.hpp"

namespace nodmap::navigator {

/// One beam in odom: where it starts, its direction, and its reading.
struct Beam {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
  double range_m = 0.0;  ///< +infinity: nothing came back
  bool is_hit = false;
};

/// The beams of a scan. Their directions in the laser plane are computed once, not for each scan.
class Fan {
 public:
  /// Prepares for a scan; returns whether its beams have other angles than those of the last one.
  bool take(const scan::Scan& scan);

  /// Beam `i` of the scan, in odom, starting at the mirror. `T_odom_mount`: of the scanner, level.
  [[nodiscard]] Beam beam(const scan::Scan& scan, std::size_t i,
                          const geometry::SE3& T_odom_mount) const;

 private:
  std::vector<Eigen::Vector2d> directions_;  // cosine and sine of each beam's angle
  double first_rad_ = 0.0;
  double step_rad_ = 0.0;
};

}  // namespace nodmap::navigator
