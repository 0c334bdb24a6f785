// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "common/geometry/time.hpp"
#include "drivers/laser3d/servo/session.hpp"
#include "drivers/serial/back_off.hpp"

namespace nodmap::laser3d {

/// Commands to a Pololu Maestro (compact protocol). It sends pulses to a servo and gets no
/// feedback: the position it reports is the pulse being sent. Answers are two unframed bytes.
namespace maestro {

[[nodiscard]] Bytes set_target(int channel, double pulse_us);
/// Limits the speed of the pulse, microseconds per second. Sends at least the smallest value,
/// because 0 means "unlimited".
[[nodiscard]] Bytes set_speed(int channel, double pulse_us_per_s);
[[nodiscard]] Bytes set_acceleration(int channel, int value);
[[nodiscard]] Bytes get_position(int channel);

/// Pulse in an answer to get_position(), microseconds.
[[nodiscard]] double pulse_us_in(ByteView answer);

}  // namespace maestro

/// The session with a hobby servo behind a Pololu Maestro, as on the historic KURT3D. Open loop:
/// the reported pitch is the commanded one, and the real pitch may differ.
class MaestroSession : public ServoSession {
 public:
  explicit MaestroSession(const ServoParams& params);

  [[nodiscard]] ServoOutput open(time::SteadyTime now) override;
  void close() override;
  [[nodiscard]] ServoOutput poll(time::SteadyTime now) override;
  [[nodiscard]] ServoOutput receive(ByteView bytes, time::SteadyTime now) override;
  void aim(double goal_rad, double speed_rad_s) override { aim_.set(goal_rad, speed_rad_s); }

  [[nodiscard]] bool is_running() const override { return is_open_ && last_error_.empty(); }
  [[nodiscard]] bool measures_pitch() const override { return false; }
  [[nodiscard]] ServoCounts line_counts() const override { return counts_; }
  [[nodiscard]] const std::string& last_error() const override { return last_error_; }

 private:
  void miss(time::SteadyTime now);
  [[nodiscard]] std::optional<PitchSample> sample_in(ByteView answer, time::SteadyTime now);

  int channel_;
  double level_us_;
  double us_per_rad_;
  time::Duration period_;
  serial::BackOff back_off_{kLongestServoPause};
  bool is_open_ = false;
  time::SteadyTime asked_;
  time::SteadyTime next_;
  bool is_waiting_ = false;
  int misses_ = 0;  // readings in a row without a usable answer
  ServoCounts counts_;
  Bytes answer_;
  std::optional<PitchSample> last_;
  PendingAim aim_;
  std::string last_error_ = "not connected";
};

}  // namespace nodmap::laser3d
