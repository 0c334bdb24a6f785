// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/navigator/obstacle_points.hpp"
#include "modules/navigator/situation.hpp"

namespace nodmap::navigator {

/// Detects that something comes nearer by its own motion, not by the robot's. People walk at 1 m/s
/// and more and do not yield, so the robot waits for them.
///
/// In each direction the nearest distance is compared with the one before. Both are measured from a
/// reference point in odom that stays where it is while the robot moves on a little, so that the
/// robot's own motion brings nothing nearer. A direction that has just come into view is not
/// compared. What comes out from behind something is not nearer either: what hid it was nearer
/// still.
class Approach {
 public:
  /// Takes the obstacles of a moment. Those farther than `reach_m` from base are only remembered.
  /// Where the robot may drive only over floor that it has seen, a point counts as approaching only
  /// if the local map has it too and floor was seen there before: what comes into view from behind
  /// a corner was there already.
  void update(const Situation& now, double reach_m, const Points& points_base);

  /// Whether something has come nearer within the last second: about the time from one measurement
  /// of it to the next, so it may still be moving.
  [[nodiscard]] bool is_detected(time::Timestamp stamp) const;

 private:
  static constexpr int kSectors = 36;
  /// The nearest point of a direction as seen from the reference point.
  struct Nearest {
    double distance_m = 0.0;
    Eigen::Vector2d p_base;
  };
  using Sectors = std::array<Nearest, kSectors>;

  [[nodiscard]] Sectors nearest(const geometry::SE2& T_odom_base, const Points& points_base) const;
  void compare(const Sectors& sectors, const Situation& now, double reach_m);

  Eigen::Vector2d reference_odom_ = Eigen::Vector2d::Zero();
  std::optional<Sectors> known_;
  std::optional<time::Timestamp> detected_at_;
};

}  // namespace nodmap::navigator
