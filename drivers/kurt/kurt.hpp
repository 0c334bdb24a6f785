// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "common/geometry/time.hpp"
#include "drivers/kurt/base_guard.hpp"
#include "drivers/kurt/drive_watchdog.hpp"
#include "drivers/kurt/encoder_clock.hpp"
#include "drivers/kurt/gyro_heading.hpp"
#include "drivers/kurt/kurt_frames.hpp"
#include "drivers/kurt/odometry.hpp"
#include "drivers/kurt/params.hpp"
#include "drivers/kurt/slcan.hpp"
#include "drivers/kurt/slcan_session.hpp"
#include "drivers/kurt/speed_limiter.hpp"

namespace nodmap::kurt {

struct OdometrySample {
  time::Timestamp stamp;
  OdometryState state;
};

/// The last value of a kind and when it was received.
template <class Value>
struct Received {
  Value value{};
  time::SteadyTime at;
};

/// The last readings of the base's other sensors.
struct BaseSensors {
  std::array<std::optional<Received<int>>, kInfraredCount> infrared_raw;
  std::optional<Received<int>> sonar_raw;
  std::optional<Received<Tilt>> tilt;
  std::optional<Received<Gyro>> gyro;
  std::optional<Received<MotorCurrents>> motor_currents;
};

struct KurtCounts {
  std::int64_t encoder_frames = 0;
  std::int64_t encoder_lost = 0;
  std::int64_t encoder_implausible = 0;
  std::int64_t encoder_gaps = 0;
};

/// After this long without encoder ticks the motion of the wheels is unknown, and the robot stops.
inline constexpr time::Duration kBlind = 200ms;

/// Whether the robot can be driven; if not, what is missing. In the order in which the states are
/// passed at startup.
enum class KurtState : std::uint8_t {
  kNoLine,   ///< the serial line is not open
  kNoBus,    ///< the adapter has not opened the CAN bus
  kNoBase,   ///< no plausible encoder frames, for example because the base is switched off
  kLate,     ///< the base's line is late, so that it is unknown what the wheels do now
  kNoDrive,  ///< no valid DRIVE: the robot is stationary
  kDriving,
};

/// Drives the KURT2 base. Takes received bytes and DRIVE requests; returns odometry and the bytes
/// to send. It has no clock, port or messages: robot, simulator and test differ only in how they
/// transport the bytes.
class Kurt {
 public:
  explicit Kurt(const KurtParams& params);

  void connected(const time::Moment& now);
  void disconnected();

  /// Takes the bytes of one read from the adapter; returns the new odometry, valid until the next
  /// call.
  std::span<const OdometrySample> receive(std::span<const std::uint8_t> bytes,
                                          const time::Moment& now);

  /// Requests a motion of the robot.
  DriveStatus drive(const DriveRequest& request, const time::Moment& now);

  /// Brakes the robot until the next DRIVE, as a DRIVE with zero speed does.
  void brake() { watchdog_.brake(); }

  /// The text to send to the adapter now: once the session is open, with a command for the base
  /// each time. To be called every 10 ms.
  [[nodiscard]] std::string control(const time::Moment& now);

  /// The text to send last: motors off and braked.
  [[nodiscard]] static std::string shutdown_command() { return to_line(hard_stop()); }

  /// Whether the port should be reopened because the adapter does not answer.
  [[nodiscard]] bool wants_new_port() const { return session_.gave_up(); }

  [[nodiscard]] KurtState state(time::SteadyTime steady) const;

  /// Whether two processes send DRIVE, so that neither is obeyed.
  [[nodiscard]] bool is_contested(time::SteadyTime steady) const {
    return watchdog_.is_contested(steady);
  }

  /// Why the base's own sensors have stopped the robot since the last call, if they have. It stays
  /// stationary until a new DRIVE is received.
  [[nodiscard]] std::optional<Alarm> take_alarm();

  /// Why the robot only creeps, if it does.
  [[nodiscard]] std::optional<Alarm> lasting_alarm() const { return guard_.lasting_alarm(); }

  [[nodiscard]] const BaseSensors& sensors() const { return sensors_; }
  [[nodiscard]] const KurtCounts& counts() const { return counts_; }
  [[nodiscard]] const GyroHeading& gyro() const { return odometry_.gyro(); }
  [[nodiscard]] const SlcanCounts& slcan_counts() const { return parser_.counts(); }
  [[nodiscard]] const SlcanSession& session() const { return session_; }

 private:
  void take_encoder(const EncoderTicks& ticks, time::SteadyTime arrival, const time::Moment& now);
  /// Counts ticks by their plausibility; returns whether odometry can use or bridge them.
  [[nodiscard]] bool accept_ticks(const EncoderTicks& ticks, time::SteadyTime arrival);
  void take_sensor(const Report& report, time::SteadyTime now);
  void take_ranges(const RangeReadings& ranges, time::SteadyTime now);

  SlcanParser parser_;
  SlcanSession session_;
  EncoderClock encoder_clock_;
  Odometry odometry_;
  SpeedLimiter limiter_;
  DriveWatchdog watchdog_;
  BaseGuard guard_;
  BaseSensors sensors_;
  KurtCounts counts_;
  std::optional<time::SteadyTime> last_encoder_;  ///< when the last plausible ticks were received
  std::optional<time::SteadyTime> last_control_;
  int implausible_in_a_row_ = 0;
  bool line_open_ = false;
  std::vector<std::variant<EncoderTicks, Gyro>> motion_;  // of one read, in order
  std::vector<OdometrySample> samples_;
};

}  // namespace nodmap::kurt
