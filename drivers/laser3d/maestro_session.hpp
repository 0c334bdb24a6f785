// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "drivers/laser3d/servo_session.hpp"
#include "drivers/serial/back_off.hpp"

namespace nodmap::laser3d {

struct MaestroSettings {
  int channel = 0;
  double level_pulse_us = 1545.0;    ///< at which the laser looks straight ahead
  double pulse_us_per_rad = -520.9;  ///< -9.09 per degree: K3's -50..+60 degrees on 2000..1000
  std::int64_t period_us = 10'000;
};

/// A hobby servo behind a Pololu Maestro, as on the historic KURT3D. Open loop: the pitch told is
/// the one being commanded, and the servo may be elsewhere.
class MaestroSession : public ServoSession {
 public:
  explicit MaestroSession(const MaestroSettings& settings) : settings_(settings) {}

  [[nodiscard]] ServoOutput open(std::int64_t now_us) override;
  void close() override;
  [[nodiscard]] ServoOutput poll(std::int64_t now_us) override;
  [[nodiscard]] ServoOutput receive(ByteView bytes, std::int64_t now_us) override;
  void aim(double goal_rad, double speed_rad_s) override;

  [[nodiscard]] bool running() const override { return open_ && trouble_.empty(); }
  [[nodiscard]] bool measures_pitch() const override { return false; }
  [[nodiscard]] const std::string& trouble() const override { return trouble_; }

 private:
  [[nodiscard]] std::optional<PitchSample> sample_in(ByteView answer, std::int64_t now_us);

  MaestroSettings settings_;
  serial::BackOff back_off_;
  bool open_ = false;
  std::int64_t asked_us_ = 0;
  std::int64_t next_us_ = 0;
  bool waiting_ = false;
  int misses_ = 0;
  Bytes answer_;
  std::optional<PitchSample> last_;
  double goal_rad_ = 0.0;
  double speed_rad_s_ = 0.0;
  bool move_pending_ = false;
  std::string trouble_ = "not connected";
};

}  // namespace nodmap::laser3d
