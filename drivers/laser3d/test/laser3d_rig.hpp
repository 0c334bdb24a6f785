// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <functional>
#include <utility>
#include <vector>

#include "drivers/laser3d/laser3d.hpp"
#include "drivers/laser3d/test/fake_sensor.hpp"
#include "drivers/laser3d/test/fake_servo.hpp"

namespace nodmap::laser3d::test {

inline constexpr time::Duration kRevolution = 13'320us;

/// Both devices on their lines, on simulated time in steps of a millisecond.
class Rig {
 public:
  explicit Rig(const Laser3dParams& params = {}) : dut(params) {
    servo.registers[11] = 3;
    servo.registers[117] = 2048 >> 8;
  }

  void open() {
    handle(dut.laser_opened(now));
    handle(dut.servo_opened(now));
  }

  void run(double seconds) {
    const time::SteadyTime end = now + time::from_seconds(seconds);
    for (; now < end; now += 1ms) {
      servo.step_ms(static_cast<int>(now.time_since_epoch() / 1ms));
      // A telegram takes 7 ms from the end of the half revolution to its last byte.
      if (sensor.streaming && now - last_scan_ >= scan_period) {
        last_scan_ += (now - last_scan_) / scan_period * scan_period;
        if (sensor.powered && sensor.baud == laser_baud) {
          const Bytes scan = sensor.next_scan();
          on_the_laser_line = on_the_laser_line + (is_lost(++num_sent_) ? Bytes{} : scan);
        }
      }
      late_.push_back({now + laser_delay, std::exchange(on_the_laser_line, {})});
      Bytes from_laser;
      while (!late_.empty() && late_.front().first <= now) {
        from_laser = from_laser + late_.front().second;
        late_.pop_front();
      }
      const Bytes from_servo = std::exchange(on_the_servo_line, {});
      handle(dut.receive_laser(from_laser, now));
      handle(dut.receive_servo(from_servo, now));
      handle(dut.poll(now));
    }
  }

  void handle(const Laser3dOutput& output) {
    for (const LineAction& action : output.laser) {
      laser_baud = action.baud.value_or(laser_baud);
      if (!action.send.empty()) {
        on_the_laser_line = on_the_laser_line + sensor.answer(action.send, laser_baud);
      }
    }
    for (const LineAction& action : output.servo) {
      on_the_servo_line = on_the_servo_line + servo.answer(action.send);
    }
    for (const SteadyScan& steady : output.scans) {
      scans.push_back(steady.scan);
      scans.back().stamp = time::Timestamp(steady.first_beam.time_since_epoch());
    }
    pitch.insert(pitch.end(), output.pitch.begin(), output.pitch.end());
  }

  [[nodiscard]] node::Health health() const { return dut.health(now); }

  Laser3d dut;
  FakeSensor sensor;
  FakeServo servo;
  time::SteadyTime now{1s};
  time::Duration scan_period = kRevolution;
  std::function<bool(int)> is_lost = [](int /*scan*/) { return false; };  // on its line
  time::Duration laser_delay{};                                           // of what the laser sends
  int laser_baud = 0;
  Bytes on_the_laser_line;
  Bytes on_the_servo_line;
  std::vector<scan::Scan> scans;
  std::vector<PitchState> pitch;

 private:
  std::deque<std::pair<time::SteadyTime, Bytes>> late_;
  time::SteadyTime last_scan_{1s};
  int num_sent_ = 0;
};

}  // namespace nodmap::laser3d::test
