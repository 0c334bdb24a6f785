// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "common/robot/footprint.hpp"
#include "modules/navigator/local_map/fan.hpp"
#include "modules/navigator/local_map/local_cell.hpp"

namespace nodmap::navigator {

/// The obstacles in the cells of the local map. Hits and contacts add evidence; beams that pass
/// through remove it. An obstacle that has not been hit again for `forget_after_m` of travel
/// (travel.hpp) is forgotten, because odometry has drifted since.
class ObstacleMemory {
 public:
  /// Beams are followed up to this distance; what lies beyond is seen again from nearer.
  static constexpr double kFarthestPassM = 3.5;

  explicit ObstacleMemory(double forget_after_m) : forget_after_m_(forget_after_m) {}

  /// Hits from now on were measured at this time.
  void begin_scan(time::Timestamp stamp);

  /// The robot has moved from one pose to another, in odom.
  void move(const geometry::SE2& from, const geometry::SE2& to);

  /// Lets obstacles near the robot, which is at `p_odom`, age more slowly: the laser does not look
  /// beside and behind the body, and an error of the heading hardly moves what is near. Forgotten
  /// obstacles stay forgotten, because odometry has drifted since, also when the stamps of cells
  /// wrap around. Call it after each move.
  void keep_near(LocalGrid& grid, const Eigen::Vector2d& p_odom);

  /// A beam of the scan number `scan` ended at `p_odom`. All uncertain beams of a scan
  /// together count once, because they share errors of pitch and tilt.
  void add_hit(LocalGrid& grid, const Eigen::Vector3d& p_odom, bool is_certain,
               std::uint16_t scan) const;

  /// The body's front, or its rear, touches something that beams do not show.
  void add_contact(LocalGrid& grid, const geometry::SE2& T_odom_base, const robot::Footprint& body,
                   bool at_front) const;

  /// Removes evidence in the cells that a beam passes over before `until_m`, if the obstacle there
  /// would have ended the beam. No obstacle is higher than `highest_m` in odom.
  static void pass(LocalGrid& grid, const Beam& beam, double until_m, double highest_m,
                   std::uint16_t scan);

  [[nodiscard]] bool is_forgotten(const LocalCell& cell) const;
  /// Whether a cell is an obstacle that is not forgotten.
  [[nodiscard]] bool is_remembered(const LocalCell& cell) const {
    return cell.is_obstacle() && !is_forgotten(cell);
  }

  /// Whether what was hit in a cell may have been somebody who walks. What has been hit there for
  /// longer than anybody who walks is in one place is something else, and so is a contact.
  [[nodiscard]] bool may_be_walker(const LocalCell& cell) const;
  /// Removes what was hit in a cell. The next hit there is of something that has just come.
  void remove_walker(LocalCell& cell) const;

  /// The travel as cells store it, in decimetres, which wrap around after 6.5 km.
  [[nodiscard]] std::uint16_t travel_dm() const;

 private:
  void keep_forgotten(LocalGrid& grid);
  [[nodiscard]] time::Duration since(std::uint16_t stamp_ds) const;

  double forget_after_m_;
  double travel_m_ = 0.0;
  std::uint16_t kept_near_at_dm_ = 0;       // travel
  std::uint16_t kept_forgotten_at_dm_ = 0;  // travel
  std::uint16_t now_ds_ = 0;                // tenths of a second
};

}  // namespace nodmap::navigator
