// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::navigator {

class LocalMap;

/// Somebody beside or behind the robot, where the laser does not look: what the base's infrared
/// range finders see, up to half a metre from the body, where floor was seen and nothing stands.
/// What stays where it is was overlooked, and is nobody who comes: it is waited for briefly, and
/// once.
class Proximity {
 public:
  static constexpr std::size_t kSensors = 7;
  /// As in nodmap.base_sensors_t, metres; NaN: nothing in the measuring range.
  using Ranges = std::array<double, kSensors>;

  /// `T_odom_base` at `stamp`.
  void add(time::Timestamp stamp, const Ranges& ranges_m, const geometry::SE2& T_odom_base,
           const LocalMap& local_map);

  /// Whether somebody is there, or was half a second ago: between two sensors nobody is seen.
  [[nodiscard]] bool is_detected(time::Timestamp stamp) const;

 private:
  /// Where a sensor sees something that the map does not have.
  struct Stranger {
    Eigen::Vector2d p_odom;
    time::Timestamp since{};
  };

  /// A stranger that did not move, and where the robot was.
  struct Standing {
    Eigen::Vector2d p_odom;
    geometry::SE2 T_odom_base;
    time::Timestamp seen{};
  };

  [[nodiscard]] bool was_stationary_there(time::Timestamp stamp, const Eigen::Vector2d& p_odom,
                                          const geometry::SE2& T_odom_base) const;
  void remember(const Standing& standing);

  std::array<std::optional<Stranger>, kSensors> strangers_;
  std::vector<Standing> standing_;  // of the last ten seconds
  std::optional<time::Timestamp> detected_at_;
};

}  // namespace nodmap::navigator
