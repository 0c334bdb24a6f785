// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/geometry/time.hpp"
#include "sim/body/robot_model.hpp"
#include "sim/devices/dynamixel_servo.hpp"
#include "sim/devices/fault.hpp"
#include "sim/devices/kurt_base.hpp"
#include "sim/devices/lms200.hpp"

namespace nodmap::sim {

/// The robot's mechanics and optics, and the imperfections of its devices.
struct SimulatedRobotParams {
  RobotModelParams model;
  Lms200Params laser;
  DynamixelParams servo;
  SlcanKurtParams base;

  template <class Visitor>
  void describe(Visitor& v) {
    model.describe(v);
    laser.describe(v);
    servo.describe(v);
    base.describe(v);
  }
};

/// The whole KURT3D: robot model, devices and injected faults. It communicates with the drivers
/// only through the bytes of its three serial lines.
class SimulatedRobot {
 public:
  static constexpr std::array kParts = {Part::kLaser, Part::kServo, Part::kBase};

  SimulatedRobot(const World& world, const SimulatedRobotParams& params,
                 const std::vector<Fault>& faults, std::uint64_t seed);

  [[nodiscard]] SerialDevice& device(Part part) { return *lines_[static_cast<std::size_t>(part)]; }
  [[nodiscard]] RobotModel& model() { return model_; }
  [[nodiscard]] const RobotModel& model() const { return model_; }

  /// Advances the robot model; to be called before the devices' transmit() for the same time.
  void advance_to(time::SteadyTime now);
  /// The next time at which a device has something to do.
  [[nodiscard]] time::SteadyTime next_due() const;

 private:
  RobotModel model_;
  std::vector<Fault> faults_;
  bool stalled_ = false;
  Lms200 laser_;
  DynamixelServo servo_;
  SlcanKurtBase base_;
  std::array<std::unique_ptr<FaultyDevice>, kParts.size()> lines_;
};

/// A laser that repeats its last measurement at each angle while one of these faults freezes it.
[[nodiscard]] Beam with_freeze_faults(Beam beam, std::vector<Fault> faults);

}  // namespace nodmap::sim
