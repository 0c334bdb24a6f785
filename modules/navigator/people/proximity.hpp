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

/// Somebody beside or behind the robot, where the laser does not look: what the base's infrared
/// range finders see, up to half a metre from the body, where floor was seen and nothing stands.
/// What stays where it is was overlooked, and is nobody who comes: it is waited for briefly.
class Proximity {
 public:
  /// As in nodmap.base_sensors_t, metres; NaN: nothing in the measuring range.
  using Ranges = std::array<double, robot::kInfraredCount>;

  /// `T_odom_base` at `stamp`. Who is tracked is no stranger: his track says when to stop for him.
  void add(time::Timestamp stamp, const Ranges& ranges_m, const geometry::SE2& T_odom_base,
           const LocalMap& local_map, const People& people_odom);

  /// Whether somebody is there, or was half a second ago: between two sensors nobody is seen.
  [[nodiscard]] bool is_detected(time::Timestamp stamp) const;

 private:
  /// Where a sensor sees something that the map does not have.
  struct Stranger {
    Eigen::Vector2d p_odom;
    time::Timestamp since{};
  };

  std::array<std::optional<Stranger>, robot::kInfraredCount> strangers_;
  std::optional<time::Timestamp> detected_at_;
};

}  // namespace nodmap::navigator
