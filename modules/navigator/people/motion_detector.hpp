// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/scan/scan.hpp"
#include "modules/navigator/people/ever_free.hpp"

namespace nodmap::navigator {

/// Something compact that a scan has measured.
struct Detection {
  Eigen::Vector2d p_odom = Eigen::Vector2d::Zero();  ///< centre of a disc with this radius
  double radius_m = 0.0;
  std::size_t first_beam = 0;  ///< of those that have hit it
  std::size_t last_beam = 0;
  double lowest_m = 0.0;  ///< heights above the floor at which they have
  double highest_m = 0.0;
  double free_ratio = 1.0;  ///< so much of it lies where space was free before
};

/// Finds what has moved, scan by scan: beams side by side that end together, most of them in
/// ever-free space, at the heights of legs. The tilted plane of a scan leaves these heights within
/// a person who is near: his place and his width are those of all beams side by side that end on
/// him.
///
/// A laser that does not nod measures the same height in each scan: there whatever is compact, and
/// not hidden in part, is found.
class MotionDetector {
 public:
  /// `T_odom_base` at the middle of the scan. `laser_is_held`: it does not nod, so that only one
  /// height is known.
  [[nodiscard]] std::vector<Detection> add_scan(const scan::Scan& scan,
                                                const geometry::SE2& T_odom_base,
                                                bool laser_is_held = false);

  [[nodiscard]] const EverFree& space() const { return space_; }

 private:
  struct Hit {
    std::size_t beam = 0;
    Eigen::Vector2d p_odom;
    double height_m = 0.0;
  };

  /// Of this scan.
  using Hits = std::vector<Hit>;

  void collect_hits(const scan::Scan& scan, const geometry::SE2& T_odom_base);
  void add_passes(const scan::Scan& scan, const geometry::SE2& T_odom_base);
  /// Of the legs' hits from `first` until before `end`, which lie side by side.
  [[nodiscard]] std::optional<Detection> detect(Hits::const_iterator first,
                                                Hits::const_iterator end,
                                                const Eigen::Vector2d& sensor_odom,
                                                const scan::Scan& scan, bool laser_is_held) const;
  /// Those of all hits that continue such a group to both sides.
  [[nodiscard]] std::span<const Hit> whole_group(const Hit& first, const Hit& last) const;

  EverFree space_;
  double farthest_m_ = 0.0;  // so far away people are looked for with this laser
  std::size_t num_beams_ = 0;
  Hits hits_;      // above the floor, in the order of the beams
  Hits leg_hits_;  // of them, those at the heights of legs
};

}  // namespace nodmap::navigator
