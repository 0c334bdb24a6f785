// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/geometry/se2.hpp"
#include "common/robot/footprint.hpp"
#include "modules/navigator/local_map/local_cell.hpp"

namespace nodmap::navigator {

/// One beam in odom: where it starts, its direction, and its reading.
struct Beam {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
  double range_m = 0.0;  ///< +infinity: nothing came back
  bool is_hit = false;
};

/// The obstacles of the local map's cells: hits and contacts add evidence, beams that pass through
/// take it away, and what was not hit again for `forget_after_m` of travel is forgotten, for
/// odometry has drifted. Travel is the path driven, and rotation by what it costs of accuracy.
class ObstacleMemory {
 public:
  /// No beam is followed farther: what lies beyond is looked at again when it is near.
  static constexpr double kFarthestPassM = 3.5;

  explicit ObstacleMemory(double forget_after_m) : forget_after_m_(forget_after_m) {}

  /// The robot has moved; poses in odom.
  void move(const geometry::SE2& from, const geometry::SE2& to);

  /// What is near the robot at `p_odom` grows older more slowly. The laser does not look beside and
  /// behind the body, and the heading's error moves what is there by next to nothing. What is
  /// forgotten stays so: its place is off by what odometry has drifted since.
  void keep_near(LocalGrid& grid, const Eigen::Vector2d& p_odom);

  /// A beam of the scan with this number ended there. The beams of one scan have their errors of
  /// pitch and tilt in common: they count once, but for those that are certain.
  void add_hit(LocalGrid& grid, const Eigen::Vector3d& p_odom, bool is_certain,
               std::uint16_t scan) const;

  /// The body's front, or its rear, touches something that beams do not show.
  void add_contact(LocalGrid& grid, const geometry::SE2& T_odom_base, const robot::Footprint& body,
                   bool at_front) const;

  /// The cells that a beam passes over before `until_m`: an obstacle there would have ended it.
  /// Nothing that is remembered is higher than `highest_m` in odom.
  static void pass(LocalGrid& grid, const Beam& beam, double until_m, double highest_m,
                   std::uint16_t scan);

  [[nodiscard]] bool is_forgotten(const LocalCell& cell) const;

  /// The travel as cells keep it: decimetres that begin anew after 6.5 km.
  [[nodiscard]] std::uint16_t travel_dm() const;

 private:
  double forget_after_m_;
  double travel_m_ = 0.0;
  std::uint16_t kept_near_at_dm_ = 0;  // travel
};

}  // namespace nodmap::navigator
