// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "modules/pitch_controller/pitch_controller.hpp"
#include "modules/pitch_controller/test/nodding_head.hpp"

namespace nodmap::pitch_controller::test {

/// The controller, the laser driver's nod and a servo in closed loop: pitch every 5 ms, speed every
/// 10 ms.
class Loop {
 public:
  explicit Loop(const PitchControllerParams& params = {}) : dut(params) {}

  /// Runs for `seconds`; `speed_mps` is called for each odometry.
  void run(double seconds, const std::function<double()>& speed_mps) {
    const time::Timestamp end = now + time::from_seconds(seconds);
    while (now < end) {
      now += 5ms;
      if (give_speed && now.time_since_epoch() % 10ms == 0us) {
        speed = speed_mps();
        dut.add_speed(now, speed);
        if (free_m) {
          dut.add_chosen_arc({now, OnArc::kDrives, *free_m, decision.max_forward_mps});
        }
        take(dut.decide(now));
      }
      if (give_pitch) {
        const PitchReading reading = head.advance_to(now);
        watch(reading);
        dut.add_pitch(reading);
        take(dut.decide(now));
      }
    }
  }
  void run(double seconds, double speed_mps) {
    run(seconds, [speed_mps] { return speed_mps; });
  }

  struct Sweep {
    double wanted_s;
    double measured_s;
  };

  /// Between the last two readings.
  [[nodiscard]] double pitch_at(time::Timestamp stamp) const {
    const double share =
        time::seconds(stamp - before_.stamp) / time::seconds(last_.stamp - before_.stamp);
    return before_.pitch_rad + share * (last_.pitch_rad - before_.pitch_rad);
  }

  PitchController dut;
  NoddingHead head;
  time::Timestamp now{};
  double speed = 0.0;
  bool give_speed = true;
  bool give_pitch = true;
  std::optional<double> free_m;  ///< of an arc on which the navigator drives as fast as permitted
  PitchDecision decision;
  std::vector<PitchDecision> decisions;
  std::vector<Sweep> sweeps;
  int readings = 0;
  int slow_readings = 0;

 private:
  void take(const std::optional<PitchDecision>& taken) {
    if (taken) {
      decision = *taken;
      decisions.push_back(*taken);
      head.obey(*taken);
    }
  }
  void watch(const PitchReading& reading) {
    before_ = std::exchange(last_, reading);
    ++readings;
    slow_readings += std::abs(reading.rate_rad_s) < 0.1 * head.goal_speed_rad_s() ? 1 : 0;
    if (reading.sweep != sweep_) {
      sweeps.push_back({dut.plan().sweep_s, time::seconds(now - reversed_)});
      sweep_ = reading.sweep;
      reversed_ = now;
    }
  }
  PitchReading before_;
  PitchReading last_;
  std::int64_t sweep_ = 0;
  time::Timestamp reversed_{};
};

}  // namespace nodmap::pitch_controller::test
