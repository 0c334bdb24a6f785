// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "modules/navigator/local_map/local_cell.hpp"
#include "modules/navigator/params.hpp"

namespace nodmap::navigator {

/// The floor that beams have met, and the floor between them. Between four neighbouring beams, two
/// of this scan and two of the last, there is floor if they met it no farther apart than
/// `max_gap_m`: an object high enough to matter would have been hit, and so would a hole wider than
/// the gap.
class FloorEvidence {
 public:
  explicit FloorEvidence(const LocalMapParams& params)
      : floor_tolerance_m_(params.floor_tolerance_m), max_gap_m_(params.max_gap_m) {}

  void begin_scan(std::size_t num_beams) { points_.assign(num_beams, {}); }

  /// A beam of the scan number `scan` met the floor; `ground_m` is the ground's height in odom.
  void add(LocalGrid& grid, std::size_t beam, const Eigen::Vector2d& p_odom, double ground_m,
           std::uint16_t scan);

  /// Fills the floor between the beams of this scan, and between this one and the last.
  void end_scan(LocalGrid& grid, std::uint16_t scan);

  /// Call it if the next scan has other beams than the last one.
  void forget_last_scan() { points_before_.clear(); }

 private:
  struct Point {
    Eigen::Vector2d p_odom = Eigen::Vector2d::Zero();
    bool is_valid = false;
  };

  void fill_line(LocalGrid& grid, const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;
  void fill_between(LocalGrid& grid, const Point (&corners)[4], std::uint16_t scan) const;

  double floor_tolerance_m_;
  double max_gap_m_;
  std::vector<Point> points_;         // of this scan, by beam
  std::vector<Point> points_before_;  // of the last one
};

}  // namespace nodmap::navigator
