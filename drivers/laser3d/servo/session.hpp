// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "common/geometry/time.hpp"
#include "drivers/serial/frame_scanner.hpp"

namespace nodmap::laser3d {

using serial::Bytes;
using serial::ByteView;

enum class ServoKind : std::uint8_t { kDynamixel, kMaestro };

struct DynamixelParams {
  int level_position = 2048;
  bool inverted = false;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("level_position", level_position, {0, 4095},
              "Position at which the laser looks straight ahead.");
    v.flag("inverted", inverted, "Set this if larger positions look down.");
  }
};

/// The defaults are those of the historic KURT3D: -50 to +60 degrees are pulses of 2000 to 1000 us.
struct MaestroParams {
  double level_us = 1545.0;
  double us_per_deg = -9.09;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("level_us", level_us, {500.0, 2500.0},
             "Pulse at which the laser looks straight ahead.");
    v.number("us_per_deg", us_per_deg, {-50.0, 50.0},
             "Change of the pulse per degree of upward pitch.");
  }
};

struct ServoParams {
  ServoKind kind = ServoKind::kDynamixel;
  std::string device;
  int baud = 1'000'000;
  int id = 1;
  double poll_hz = 200.0;
  DynamixelParams dynamixel;
  MaestroParams maestro;

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("kind", kind, {{"dynamixel", ServoKind::kDynamixel}, {"maestro", ServoKind::kMaestro}},
             "Pitch servo: Dynamixel X (measured pitch) or Pololu Maestro (open loop).");
    v.text("device", device,
           "Serial port of the servo, preferably /dev/serial/by-id/...; required.");
    v.integer("baud", baud, {9600, 4'500'000}, "Rate of the servo's serial line, bit/s.");
    v.integer("id", id, {0, 252}, "Dynamixel id, or Maestro channel.");
    v.number("poll_hz", poll_hz, {20.0, 500.0}, "How often the pitch is read.");
    v.section("dynamixel", dynamixel);
    v.section("maestro", maestro);
  }

  /// Time from one reading of the pitch to the next.
  [[nodiscard]] time::Duration period() const { return time::from_seconds(1.0 / poll_hz); }
};

/// The pitch at one moment.
struct PitchSample {
  time::SteadyTime stamp;
  double pitch_rad = 0.0;   ///< positive looks up
  double rate_rad_s = 0.0;  ///< positive: upwards
};

struct ServoOutput {
  Bytes send;
  std::optional<PitchSample> sample;
};

/// Where the head is to be, and whether the servo has still to be told.
class PendingAim {
 public:
  void set(double goal_rad, double speed_rad_s) {
    if (goal_rad != goal_rad_ || speed_rad_s != speed_rad_s_) {
      goal_rad_ = goal_rad;
      speed_rad_s_ = speed_rad_s;
      is_pending_ = true;
    }
  }
  /// The servo has to be told again.
  void repeat() { is_pending_ = true; }
  /// The servo has just been initialised: it is told only if it is to move.
  void restart() { is_pending_ = speed_rad_s_ > 0.0; }
  /// Returns whether the servo has to be told, which the caller does then.
  [[nodiscard]] bool take() { return std::exchange(is_pending_, false); }

  [[nodiscard]] double goal_rad() const { return goal_rad_; }
  [[nodiscard]] double speed_rad_s() const { return speed_rad_s_; }

 private:
  double goal_rad_ = 0.0;
  double speed_rad_s_ = 0.0;
  bool is_pending_ = false;
};

/// The longest pause before a silent servo is queried again. A query costs a few bytes, and the
/// robot halts until one is answered: when the line is sound again, after a second at most.
inline constexpr time::Duration kLongestServoPause = 1s;

/// What has happened on the servo's line.
struct ServoCounts {
  std::int64_t connections = 0;      ///< how often the servo was initialised
  std::int64_t unanswered = 0;       ///< requests
  std::int64_t damaged = 0;          ///< requests that arrived damaged, according to the servo
  std::int64_t checksum_errors = 0;  ///< of answers
  std::int64_t implausible = 0;      ///< positions that the head cannot have
  std::int64_t shutdowns = 0;        ///< by the servo itself, for example overloaded
};

/// The session with a pitch servo, for any protocol: initialises it, moves it and reads its
/// position periodically. A pure state machine without clock or port.
class ServoSession : private boost::noncopyable {
 public:
  virtual ~ServoSession() = default;

  /// To be called when the line has been opened.
  [[nodiscard]] virtual ServoOutput open(time::SteadyTime now) = 0;
  /// To be called when the line is gone.
  virtual void close() = 0;
  /// To be called at least every few milliseconds.
  [[nodiscard]] virtual ServoOutput poll(time::SteadyTime now) = 0;
  [[nodiscard]] virtual ServoOutput receive(ByteView bytes, time::SteadyTime now) = 0;
  /// Sets goal and speed, to be sent by the next poll().
  virtual void aim(double goal_rad, double speed_rad_s) = 0;

  /// Whether the servo is initialised and its position is known.
  [[nodiscard]] virtual bool is_running() const = 0;
  /// Whether the pitch of the samples is measured; otherwise it is the commanded one.
  [[nodiscard]] virtual bool measures_pitch() const = 0;
  [[nodiscard]] virtual ServoCounts line_counts() const = 0;
  /// Why the servo is not running; empty while it is.
  [[nodiscard]] virtual const std::string& last_error() const = 0;
  /// What is wrong although the servo is running; empty if nothing is.
  [[nodiscard]] virtual std::string warning() const { return {}; }
};

}  // namespace nodmap::laser3d
