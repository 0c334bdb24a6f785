// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/scan/scan.hpp"
#include "modules/navigator/people/detection.hpp"
#include "modules/navigator/people/ever_free.hpp"

namespace nodmap::navigator {

/// Finds in each scan what has moved: groups of neighbouring beams that end close together at the
/// height of legs, most of them in ever-free space. On a person who is near, only a part of the
/// tilted scan is at the height of legs. Place and width are therefore computed from all
/// neighbouring beams that end on the person.
///
/// A laser that does not nod measures at one height only. Then everything compact that is not
/// partly hidden is detected.
class MotionDetector {
 public:
  /// `T_odom_base`: at the middle of the scan. `laser_is_held`: the laser does not nod, so only one
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

  using Hits = std::vector<Hit>;

  void collect_hits(const scan::Scan& scan, const geometry::SE2& T_odom_base, bool laser_is_held);
  void add_passes(const scan::Scan& scan, const geometry::SE2& T_odom_base);
  /// Adds what a group of neighbouring hits at the height of legs shows: a body, a leg or two legs.
  /// `end` is past the last.
  void detect(Hits::const_iterator first, Hits::const_iterator end,
              const Eigen::Vector2d& sensor_odom, const scan::Scan& scan, bool laser_is_held,
              std::vector<Detection>& detections) const;
  [[nodiscard]] static bool is_leg(std::span<const Hit> group);
  [[nodiscard]] static Detection detection_of(std::span<const Hit> group, bool is_leg,
                                              const Eigen::Vector2d& sensor_odom);
  /// All hits, at any height, that continue such a group to both sides.
  [[nodiscard]] std::span<const Hit> whole_group(const Hit& first, const Hit& last) const;

  EverFree space_;
  double farthest_m_ = 0.0;  // range of detection with this laser
  std::size_t num_beams_ = 0;
  Hits hits_;      // of this scan above the floor, in the order of the beams
  Hits leg_hits_;  // of them, those at the heights of legs
};

}  // namespace nodmap::navigator
