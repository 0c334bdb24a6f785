// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "drivers/kurt/kurt.hpp"
#include "drivers/kurt/test/kurt_emulator.hpp"

namespace nodmap::kurt::kurt_robot {

inline constexpr time::Timestamp kStart{1'700'000'000s};

/// The driver's core and the emulated base behind it, on simulated time.
class Robot {
 public:
  Robot() { kurt.connected(moment()); }

  [[nodiscard]] time::Moment moment() const { return {kStart + now.time_since_epoch(), now}; }

  // One control period: the base sends, the driver takes it in and answers.
  void step() {
    now += 10ms;
    sent.push_back(std::exchange(answers, {}) + base.tick());
    while (std::ssize(sent) > late_periods) {
      to_driver += sent.front();
      sent.pop_front();
    }
    if (held_up_periods > 0) {
      --held_up_periods;
    } else {
      const std::vector<std::uint8_t> bytes(to_driver.begin(), to_driver.end());
      to_driver.clear();
      for (const OdometrySample& sample : kurt.receive(bytes, moment())) {
        samples.push_back(sample);
      }
    }
    const std::string answer = base.take(kurt.control(moment()));
    (late_periods > 0 ? answers : to_driver) += answer;
  }

  // Lines from the adapter, besides those of the base.
  void receive(const std::string& lines) {
    const std::vector<std::uint8_t> bytes(lines.begin(), lines.end());
    kurt.receive(bytes, moment());
  }

  void run_for(time::Duration duration) {
    for (const time::SteadyTime end = now + duration; now < end;) {
      step();
    }
  }

  DriveStatus drive(double forward_mps, double yaw_rate_rad_s) {
    return kurt.drive({{forward_mps, yaw_rate_rad_s}, moment().wall, 1s}, moment());
  }

  // Drives as a navigator does, with a DRIVE every 10 ms.
  void drive_for(double forward_mps, double yaw_rate_rad_s, time::Duration duration) {
    for (const time::SteadyTime end = now + duration; now < end;) {
      ASSERT_EQ(drive(forward_mps, yaw_rate_rad_s), DriveStatus::kObeyed);
      step();
    }
  }

  Kurt kurt{KurtParams{}};
  nodmap::test::KurtEmulator base;
  time::SteadyTime now;
  int held_up_periods = 0;
  int late_periods = 0;  ///< by which all that the adapter sends arrives late
  std::deque<std::string> sent;
  std::string answers;
  std::string to_driver;
  std::vector<OdometrySample> samples;
};

}  // namespace nodmap::kurt::kurt_robot
