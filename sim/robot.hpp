// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "sim/dynamixel_emulator.hpp"
#include "sim/faulty_device.hpp"
#include "sim/lms200.hpp"
#include "sim/plant.hpp"
#include "sim/slcan_kurt_emulator.hpp"

namespace nodmap::sim {

struct RobotSettings {
  Lms200Settings laser;
  DynamixelSettings servo;
  SlcanKurtSettings base;
};

/// The whole KURT3D: plant and devices, with what is to go wrong. Everything between it and the
/// drivers are the bytes of its three lines.
class Robot {
 public:
  static constexpr std::array kParts = {Part::kLaser, Part::kServo, Part::kBase};

  Robot(const World& world, const PlantParams& params, const RobotSettings& settings,
        const std::vector<Fault>& faults, std::uint64_t seed);

  /// The line of a part.
  [[nodiscard]] Device& device(Part part) { return lines_[static_cast<std::size_t>(part)]; }
  [[nodiscard]] const Plant& plant() const { return plant_; }

  /// Moves the plant on. The devices' transmit() wants the plant to be at its time.
  void advance_to(std::int64_t now_us);
  /// When one of the devices has something to do.
  [[nodiscard]] std::int64_t next_us() const;

 private:
  Plant plant_;
  std::vector<Fault> servo_faults_;
  bool stalled_ = false;
  Lms200 laser_;
  DynamixelEmulator servo_;
  SlcanKurtEmulator base_;
  std::array<FaultyDevice, kParts.size()> lines_;
};

}  // namespace nodmap::sim
