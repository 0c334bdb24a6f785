// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/scan/scan.hpp"
#include "modules/navigator/people/ever_free.hpp"

namespace nodmap::navigator {

/// Something compact that a scan has measured where space was free before.
struct Detection {
  Eigen::Vector2d p_odom = Eigen::Vector2d::Zero();  ///< centre of a disc with this radius
  double radius_m = 0.0;
  std::size_t first_beam = 0;  ///< of those that have hit it
  std::size_t last_beam = 0;
};

/// Finds what has moved, scan by scan: beams side by side that end together, most of them in
/// ever-free space, at the heights of legs.
class MotionDetector {
 public:
  /// `T_odom_base` at the middle of the scan.
  [[nodiscard]] std::vector<Detection> add_scan(const scan::Scan& scan,
                                                const geometry::SE2& T_odom_base);

  [[nodiscard]] const EverFree& space() const { return space_; }

 private:
  struct Hit {
    std::size_t beam = 0;
    Eigen::Vector2d p_odom;
    double height_m = 0.0;
  };

  void collect_hits(const scan::Scan& scan, const geometry::SE2& T_odom_base);
  void add_passes(const scan::Scan& scan, const geometry::SE2& T_odom_base);
  /// Of the hits from `first` until before `end`, which lie side by side.
  [[nodiscard]] std::optional<Detection> detect(std::size_t first, std::size_t end,
                                                const Eigen::Vector2d& sensor_odom) const;

  EverFree space_;
  std::vector<Hit> hits_;  // of this scan, reused
};

}  // namespace nodmap::navigator
