// SPDX-License-Identifier: BSD-3-Clause
#include "sim/robot.hpp"

#include <algorithm>
#include <utility>

namespace nodmap::sim {

Robot::Robot(const World& world, const PlantParams& params, const RobotSettings& settings,
             const std::vector<Fault>& faults, std::uint64_t seed)
    : plant_(world, params, seed),
      servo_faults_(faults_of(Part::kServo, faults)),
      laser_(settings.laser,
             freezing([this](double angle_rad,
                             std::int64_t time_us) { return plant_.measure(angle_rad, time_us); },
                      faults_of(Part::kLaser, faults))),
      servo_(settings.servo, plant_),
      base_(settings.base, plant_),
      lines_{FaultyDevice(laser_, faults_of(Part::kLaser, faults), seed + 1),
             FaultyDevice(servo_, servo_faults_, seed + 2),
             FaultyDevice(base_, faults_of(Part::kBase, faults), seed + 3)} {}

void Robot::advance_to(std::int64_t now_us) {
  const bool stalled =
      std::any_of(servo_faults_.begin(), servo_faults_.end(), [now_us](const Fault& fault) {
        return fault.kind == FaultKind::kStall && fault.active(now_us);
      });
  if (stalled != std::exchange(stalled_, stalled)) {
    plant_.jam_pitch(stalled);
  }
  plant_.advance_to(now_us);
}

std::int64_t Robot::next_us() const {
  std::int64_t next = kNever;
  for (const FaultyDevice& line : lines_) {
    next = std::min(next, line.next_us());
  }
  return next;
}

}  // namespace nodmap::sim
