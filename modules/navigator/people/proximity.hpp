// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "common/robot/infrared.hpp"
#include "modules/navigator/people/person.hpp"

namespace nodmap::navigator {

class LocalMap;

/// Detects people who approach beside or behind the robot, where the laser does not look. They show
/// as readings of the base's infrared range finders, up to half a metre from the body, in places
/// where the local map has free floor. For what does not move the robot waits only briefly: the
/// laser had overlooked it.
class Proximity {
 public:
  /// As in nodmap.base_sensors_t, metres; NaN: nothing in the measuring range.
  using Ranges = std::array<double, robot::kInfraredCount>;

  /// Adds readings; `T_odom_base` is the pose at `stamp`. Readings on a tracked person are left
  /// out, because the robot stops for the track.
  void add(time::Timestamp stamp, const Ranges& ranges_m, const geometry::SE2& T_odom_base,
           const LocalMap& local_map, const People& people_odom);

  /// Whether somebody is there, or was within the last half second: between two sensors a person is
  /// not seen.
  [[nodiscard]] bool is_detected(time::Timestamp stamp) const;

 private:
  /// A reading on something that the local map does not show.
  struct Stranger {
    Eigen::Vector2d p_odom;
    time::Timestamp since{};
  };

  std::array<std::optional<Stranger>, robot::kInfraredCount> strangers_;
  std::optional<time::Timestamp> detected_at_;
};

}  // namespace nodmap::navigator
