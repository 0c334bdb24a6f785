// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"
#include "drivers/kurt/base_guard.hpp"
#include "drivers/kurt/drive_watchdog.hpp"
#include "drivers/kurt/encoder_clock.hpp"
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

/// The last value of a kind, and when it came (monotonic clock).
template <class Value>
struct Received {
  Value value{};
  time::SteadyTime at;
};

/// What the base's other sensors said last.
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

/// Whether the robot can be driven, and if not, what is missing; in the order of getting there.
enum class KurtState : std::uint8_t {
  kNoLine,   ///< the serial line is not open
  kNoBus,    ///< the adapter has not opened the CAN bus
  kNoBase,   ///< no encoder frames that wheels can have made: the base is switched off, say
  kNoDrive,  ///< nobody tells the robot to move: it is stationary
  kDriving,
};

/// Drives the KURT2 base, as bytes and values: what the base says goes in, what to send to it comes
/// out. No clock, no port, no message; robot, simulator and test differ in who carries the bytes.
class Kurt {
 public:
  explicit Kurt(const KurtParams& params);

  void connected(const time::Moment& now);
  void disconnected();

  /// Bytes from the adapter, as one read gave them. Valid until the next call.
  std::span<const OdometrySample> receive(std::span<const std::uint8_t> bytes,
                                          const time::Moment& now);

  /// Somebody wants the robot to move.
  DriveStatus drive(const DriveRequest& request, const time::Moment& now);

  /// What to send to the adapter now. To be called every 10 ms: there is a command in it each time.
  [[nodiscard]] std::string control(const time::Moment& now);

  /// What to send last: motors off and braked.
  [[nodiscard]] static std::string shutdown_command() { return to_line(hard_stop()); }

  /// The adapter does not answer on this port: it should be opened anew.
  [[nodiscard]] bool wants_new_port() const { return session_.gave_up(); }

  [[nodiscard]] KurtState state(time::SteadyTime steady) const;

  /// Whether two processes send DRIVE, so that none of them is obeyed.
  [[nodiscard]] bool is_contested(time::SteadyTime steady) const {
    return watchdog_.is_contested(steady);
  }

  /// Why the base's own senses have stopped the robot since the last call, if they have; it stays
  /// stationary until a new DRIVE comes.
  [[nodiscard]] std::optional<Alarm> take_alarm();

  [[nodiscard]] const BaseSensors& sensors() const { return sensors_; }
  [[nodiscard]] const KurtCounts& counts() const { return counts_; }
  [[nodiscard]] const SlcanCounts& slcan_counts() const { return parser_.counts(); }
  [[nodiscard]] const SlcanSession& session() const { return session_; }

 private:
  void take_encoder(const EncoderTicks& ticks, time::SteadyTime arrival, const time::Moment& now);
  /// Whether odometry goes on with these ticks, if only by bridging them.
  [[nodiscard]] bool is_of_use(const EncoderTicks& ticks, time::SteadyTime arrival);
  void take_sensor(const Report& report, time::SteadyTime now);

  SlcanParser parser_;
  SlcanSession session_;
  EncoderClock encoder_clock_;
  Odometry odometry_;
  SpeedLimiter limiter_;
  DriveWatchdog watchdog_;
  BaseGuard guard_;
  BaseSensors sensors_;
  KurtCounts counts_;
  std::optional<time::SteadyTime> last_encoder_;  ///< of the last ticks that wheels can have made
  int implausible_in_a_row_ = 0;
  bool line_open_ = false;
  std::vector<EncoderTicks> ticks_;
  std::vector<OdometrySample> samples_;
};

}  // namespace nodmap::kurt
