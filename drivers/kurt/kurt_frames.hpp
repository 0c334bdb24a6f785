// SPDX-License-Identifier: BSD-3-Clause
// The CAN frames of a KURT2 base. All numbers in them are big-endian.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>

#include "common/geometry/angle.hpp"
#include "common/geometry/time.hpp"
#include "common/robot/infrared.hpp"
#include "drivers/kurt/slcan.hpp"

namespace nodmap::kurt {

/// Speeds of the wheels over ground, positive forward.
struct WheelSpeeds {
  double left_mps = 0.0;
  double right_mps = 0.0;
};

/// Period at which the base is sent its commands.
inline constexpr time::Duration kControlPeriod = 10ms;
/// After this long without a command the base stops by itself.
inline constexpr time::Duration kBaseTimeout = 100ms;

/// Commands the base's own speed controller, in steps of 1 cm/s.
[[nodiscard]] CanFrame speed_command(const WheelSpeeds& speeds);

/// Switches both motors off and brakes them.
[[nodiscard]] CanFrame hard_stop();

/// Encoder ticks of the last 10 ms, positive forward.
struct EncoderTicks {
  int left = 0;
  int right = 0;
};

using robot::Infrared;
using robot::kInfraredCount;

/// The range finders' raw readings in one frame; empty for those that are not in this frame.
struct RangeReadings {
  std::array<std::optional<int>, kInfraredCount> infrared_raw;
  std::optional<int> sonar_raw;
};

struct Bumpers {
  bool is_touched = false;
};

struct Tilt {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
};

/// How far apart the ends of the gyro's 32 bits are.
inline constexpr double kGyroRangeRad = geometry::deg_to_rad(4294967296.0 / 4992511.0);

/// The angle wraps; see GyroHeading.
struct Gyro {
  double yaw_rad = 0.0;
  double variance_rad2 = 0.0;
};

struct MotorCurrents {
  double left_a = 0.0;
  double right_a = 0.0;
};

using Report =
    std::variant<std::monostate, EncoderTicks, RangeReadings, Bumpers, Tilt, Gyro, MotorCurrents>;

/// Decodes a frame from the base; std::monostate for frames that we do not use, and for those that
/// are too short.
[[nodiscard]] Report decode(const CanFrame& frame);

/// Range of a Sharp GP2D12, metres: 0 for what is too near to measure (above 800, 3.4 cm), empty if
/// nothing is near enough (below 100, 0.53 m).
[[nodiscard]] std::optional<double> infrared_range_m(int raw);

/// Range of the Baumer UNDK30, metres; empty for readings outside 100 to 1000.
[[nodiscard]] std::optional<double> sonar_range_m(int raw);

}  // namespace nodmap::kurt
