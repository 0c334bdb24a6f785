// SPDX-License-Identifier: BSD-3-Clause
#include "sim/devices/simulated_robot.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace nodmap::sim {

SimulatedRobot::SimulatedRobot(const World& world, const SimulatedRobotParams& params,
                               const std::vector<Fault>& faults, std::uint64_t seed)
    : model_(world, params.model, seed),
      faults_(faults),
      laser_(params.laser, with_freeze_faults(
                               [this](double angle_rad, time::SteadyTime fired) {
                                 return model_.measure(angle_rad, fired);
                               },
                               faults)),
      servo_(params.servo, model_),
      base_(params.base, model_, {}, seed),
      lines_{std::make_unique<FaultyDevice>(laser_, faults_of(Part::kLaser, faults), seed + 1),
             std::make_unique<FaultyDevice>(servo_, faults_of(Part::kServo, faults), seed + 2),
             std::make_unique<FaultyDevice>(base_, faults_of(Part::kBase, faults), seed + 3)} {}

void SimulatedRobot::advance_to(time::SteadyTime now) {
  const bool stalled = is_any_active(FaultKind::kStall, faults_, now);
  if (stalled != std::exchange(stalled_, stalled)) {
    model_.set_pitch_jammed(stalled);
  }
  model_.advance_to(now);
}

time::SteadyTime SimulatedRobot::next_due() const {
  time::SteadyTime next = kNever;
  for (const auto& line : lines_) {
    next = std::min(next, line->next_due());
  }
  return next;
}

Beam with_freeze_faults(Beam beam, std::vector<Fault> faults) {
  std::erase_if(faults, [](const Fault& fault) { return fault.kind != FaultKind::kFreeze; });
  if (faults.empty()) {
    return beam;
  }
  return [beam = std::move(beam), faults = std::move(faults),
          last_echoes = std::map<std::int64_t, Echo>()](double angle_rad,
                                                        time::SteadyTime fired) mutable {
    const std::int64_t key = std::lround(1e5 * angle_rad);
    const auto last = last_echoes.find(key);
    if (last != last_echoes.end() && is_any_active(FaultKind::kFreeze, faults, fired)) {
      return last->second;
    }
    return last_echoes[key] = beam(angle_rad, fired);
  };
}

}  // namespace nodmap::sim
