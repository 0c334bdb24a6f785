// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "common/geometry/time.hpp"
#include "drivers/laser3d/passive_sync.hpp"
#include "drivers/laser3d/servo/dynamixel_x.hpp"
#include "drivers/laser3d/servo/session.hpp"
#include "drivers/serial/back_off.hpp"

namespace nodmap::laser3d {

/// Dynamixel X series, protocol 2.0. The session with a servo. There is one request at a time. A
/// reading contains tick, velocity and position of one moment; the tick gives the time of that
/// moment.
class DynamixelSession : public ServoSession {
 public:
  /// The head accelerates by at most `acceleration_rad_s2`.
  DynamixelSession(const ServoParams& params, double acceleration_rad_s2);

  [[nodiscard]] ServoOutput open(time::SteadyTime now) override;
  void close() override;
  [[nodiscard]] ServoOutput poll(time::SteadyTime now) override;
  [[nodiscard]] ServoOutput receive(ByteView bytes, time::SteadyTime now) override;
  void aim(double goal_rad, double speed_rad_s) override { aim_.set(goal_rad, speed_rad_s); }

  [[nodiscard]] bool is_running() const override {
    return step_ == Step::kRun && last_error_.empty();
  }
  [[nodiscard]] bool measures_pitch() const override { return true; }
  [[nodiscard]] const std::string& last_error() const override { return last_error_; }
  [[nodiscard]] std::string warning() const override;
  [[nodiscard]] ServoCounts line_counts() const override;

 private:
  enum class Step : std::uint8_t {
    kClosed,
    kPing,
    kClearWatchdog,  // it may have triggered since the last session
    kTorqueOff,      // the mode can only be changed without torque
    kReadMode,
    kWriteMode,
    kAcceleration,
    kTorqueOn,
    kWatchdog,
    kRun,
    kReboot,
    kWait,
  };

  [[nodiscard]] Bytes request() const;
  /// Whether it can be the answer to the present request, by its number of parameters, because an
  /// answer does not say which request it belongs to. Others may come first: those to the driver
  /// that ran before this one, or to a request that was repeated.
  [[nodiscard]] bool is_expected(const DynamixelStatus& answer) const;
  [[nodiscard]] ServoOutput enter(Step step, time::SteadyTime now);
  [[nodiscard]] ServoOutput ask(Bytes bytes, time::SteadyTime now);
  [[nodiscard]] ServoOutput run(time::SteadyTime now);
  [[nodiscard]] ServoOutput missed(time::SteadyTime now);
  [[nodiscard]] ServoOutput take(const DynamixelStatus& answer, time::SteadyTime now);
  [[nodiscard]] ServoOutput advance(const DynamixelStatus& answer, time::SteadyTime now);
  [[nodiscard]] ServoOutput fail(std::string reason, time::SteadyTime now);
  /// Restarts the servo if it has switched itself off, and otherwise continues.
  [[nodiscard]] ServoOutput take(const dynamixel_x::HardwareErrors& errors, time::SteadyTime now);
  /// Follows the clock of the servo; returns whether it has jumped, as it does at a restart.
  [[nodiscard]] bool watch_for_restart(const dynamixel_x::State& state, time::SteadyTime now);
  /// Converts a reading; empty if the head cannot be at this position.
  [[nodiscard]] std::optional<PitchSample> sample_of(const dynamixel_x::State& state,
                                                     time::SteadyTime first_byte);

  ServoParams params_;
  std::uint8_t id_;
  double acceleration_rad_s2_;
  DynamixelParser parser_;
  PassiveSync sync_;
  serial::BackOff back_off_{kLongestServoPause};
  Step step_ = Step::kClosed;
  bool is_waiting_ = false;  // for an answer
  std::size_t expected_parameters_ = 0;
  time::SteadyTime deadline_;
  time::SteadyTime next_reading_;
  int misses_ = 0;                           // in a row
  std::optional<time::SteadyTime> started_;  // when the servo's tick was 0, by the last reading
  PendingAim aim_;
  time::SteadyTime next_alert_check_;
  std::string last_error_ = "not connected";
  std::string warning_;
  ServoCounts counts_;
};

}  // namespace nodmap::laser3d
