// SPDX-License-Identifier: BSD-3-Clause
// The lines of a CARMEN log (.clf), as values. Poses are in the frame of the log's odometry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::convert {

/// Readings from here on mean "no echo" with the SICK scanners that CARMEN supports (81.83 and
/// 81.91 in the public logs).
inline constexpr double kCarmenNoReturnM = 80.0;

enum class LaserSide : std::uint8_t { kFront, kRear };

struct CarmenOdometry {
  time::Timestamp stamp{};
  geometry::SE2 T_odom_base;
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
};

/// FLASER, RLASER or ROBOTLASER1: a scan with the poses of scanner and robot.
struct CarmenScan {
  time::Timestamp stamp{};
  LaserSide side = LaserSide::kFront;
  geometry::SE2 T_odom_laser;
  geometry::SE2 T_odom_base;
  double angle_first_rad = 0.0;  ///< 0 ahead, positive to the left
  double angle_step_rad = 0.0;
  double range_max_m = kCarmenNoReturnM;
  std::vector<float> ranges_m;  ///< +infinity: no echo
  std::vector<float> intensities;
};

struct CarmenParameter {
  std::string name;
  std::string value;
};

/// A line that this program does not use: a comment (without a name), or another kind of message.
struct CarmenOther {
  std::string name;
};

struct CarmenUnreadable {
  std::string why;
};

using CarmenLine =
    std::variant<CarmenOther, CarmenOdometry, CarmenScan, CarmenParameter, CarmenUnreadable>;

[[nodiscard]] CarmenLine parse_carmen_line(std::string_view line);

/// The fan of a FLASER line, which contains only the number of beams.
struct CarmenFan {
  double angle_first_rad = 0.0;
  double angle_step_rad = 0.0;
};
[[nodiscard]] CarmenFan carmen_fan(std::size_t num_beams);

}  // namespace nodmap::convert
