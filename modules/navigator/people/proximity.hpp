// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "common/robot/infrared.hpp"
#include "modules/navigator/obstacle_points.hpp"
#include "modules/navigator/people/person.hpp"

namespace nodmap::navigator {

class LocalMap;

/// Detects people who approach beside or behind the robot, where the laser does not look. They show
/// as readings of the base's infrared range finders, up to half a metre from the body, in places
/// where the local map has free floor. What does not move for 0.6 s becomes an obstacle, and the
/// robot no longer waits for it: somebody who stands there, or something that the laser overlooked.
/// It remains one until a range finder looks through its place, or the robot is 1 m away.
class Proximity {
 public:
  /// As in nodmap.base_sensors_t, metres; infinity: nothing in the measuring range; NaN: no answer.
  using Ranges = std::array<double, robot::kInfraredCount>;

  /// Whether a range finder has measured something. None measures farther than 2 m: larger ranges
  /// are invalid, and so are NaN and infinity.
  [[nodiscard]] static bool is_reading(double range_m) { return range_m >= 0.0 && range_m <= 2.0; }

  /// Adds readings; `T_odom_base` is the pose at `stamp`. Readings on a tracked person are left
  /// out, because the robot stops for the track.
  void add(time::Timestamp stamp, const Ranges& ranges_m, const geometry::SE2& T_odom_base,
           const LocalMap& local_map, const People& people_odom);

  /// Whether somebody is there, or was within the last half second: between two sensors a person is
  /// not seen.
  [[nodiscard]] bool is_detected(time::Timestamp stamp) const;

  /// What stands beside or behind the robot, in base: for each place, points across the reading, as
  /// far apart as cells of the local map.
  [[nodiscard]] Points points_base(const geometry::SE2& T_odom_base) const;

 private:
  /// A reading on something that the local map does not show.
  struct Stranger {
    Eigen::Vector2d p_odom;
    time::Timestamp since{};
  };

  void forget_far_places(const geometry::SE2& T_odom_base);
  void forget_places_before(const geometry::SE2& T_odom_sensor, double range_m);

  std::array<std::optional<Stranger>, robot::kInfraredCount> strangers_;
  /// By sensor: where something stands, in odom, the x axis along the beam.
  std::array<std::optional<geometry::SE2>, robot::kInfraredCount> standing_;
  std::optional<time::Timestamp> detected_at_;
};

}  // namespace nodmap::navigator
