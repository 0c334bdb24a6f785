// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/geometry/time.hpp"
#include "common/robot/infrared.hpp"
#include "sim/body/robot_model.hpp"
#include "sim/devices/serial_device.hpp"
#include "sim/devices/slcan_adapter.hpp"
#include "sim/devices/yaw_gyro.hpp"

namespace nodmap::sim {

struct KurtBaseParams {
  double wheel_perimeter_m = 0.379;
  double ticks_per_revolution = 21'950.0;
  double clock_ppm = 20.0;
  bool has_infrared = true;  ///< without range finders the readings are those of nothing in view
  bool tilt_feels_acceleration = false;
  YawGyroParams gyro{};

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("base_clock_ppm", clock_ppm, {-2000.0, 2000.0},
             "Error of the base's clock; positive: too slow.");
    v.flag("tilt_feels_acceleration", tilt_feels_acceleration,
           "Let the tilt sensor take the base's acceleration for tilt, as an accelerometer does: 1 "
           "m/s^2 for 5.8 degrees.");
    gyro.describe(v);
  }
};

/// The controller of a KURT2: CAN frames in and out. It sends encoder ticks every 10 ms and one
/// other kind of reading in between, and stops when no command has arrived for 100 ms.
class KurtBase {
 public:
  KurtBase(const KurtBaseParams& params, RobotModel& model, time::SteadyTime power_on,
           std::uint64_t seed);

  void receive(const CanFrame& frame, time::SteadyTime now);

  /// Time of the next frame or command timeout.
  [[nodiscard]] time::SteadyTime next_due() const;
  /// When the next frame is sent.
  [[nodiscard]] time::SteadyTime frame_due() const;
  /// The next frame; the robot model must be at its time.
  [[nodiscard]] CanFrame next_frame();
  /// Stops the motors when no command has arrived for 100 ms.
  void check_command_timeout(time::SteadyTime now);

 private:
  void control(const CanFrame& frame);
  void control_raw(const CanFrame& frame);
  void reset(time::SteadyTime now);
  [[nodiscard]] CanFrame encoder_frame();
  [[nodiscard]] CanFrame sensor_frame(std::int64_t period);
  /// Reading of the infrared range finder at a place on the body, in base.
  [[nodiscard]] std::int64_t infrared_reading(robot::Infrared sensor) const;
  [[nodiscard]] std::int64_t ticks(double distance_m) const;

  KurtBaseParams params_;
  RobotModel& model_;
  time::SteadyTime start_;
  std::int64_t slot_ = 1;  // two in each period: encoders, then another reading
  time::SteadyTime last_command_;
  bool has_timed_out_ = true;
  std::int64_t left_reported_ = 0;  // ticks since the start
  std::int64_t right_reported_ = 0;
  YawGyro gyro_;
};

struct SlcanKurtParams {
  int baud = 1'000'000;
  KurtBaseParams base;

  template <class Visitor>
  void describe(Visitor& v) {
    base.describe(v);
  }
};

/// A KURT2 behind an SLCAN adapter, at the end of a serial line.
class SlcanKurtBase final : public SerialDevice {
 public:
  SlcanKurtBase(const SlcanKurtParams& params, RobotModel& model, time::SteadyTime power_on = {},
                std::uint64_t seed = 0);

  void receive(ByteView bytes, int baud, time::SteadyTime now) override;
  void transmit(time::SteadyTime now, int baud, Bytes& line) override;
  [[nodiscard]] time::SteadyTime next_due() const override;

 private:
  void send(const std::string& text, time::SteadyTime from);

  int baud_;
  KurtBase base_;
  time::SteadyTime now_;  // of the bytes being received
  SlcanAdapter adapter_;
  SerialOutput output_;
};

}  // namespace nodmap::sim
