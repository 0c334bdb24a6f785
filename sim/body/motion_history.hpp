// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "sim/body/pitch_servo.hpp"
#include "sim/body/skid_steer_base.hpp"
#include "sim/world/world.hpp"

namespace nodmap::sim {

/// The state of everything that moves, at the end of a step of the simulation.
struct Step {
  time::SteadyTime instant{};
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  PitchState pitch;
  WheelTravel travel;
  std::vector<ActorState> actors;  ///< only those that are present
};

/// The same at any time: between two steps, by linear interpolation.
class Moment {
 public:
  /// `fraction`: of the time from one step to the other.
  Moment(const Step& from, const Step& to, double fraction)
      : from_(from), to_(to), fraction_(fraction) {}

  [[nodiscard]] geometry::SE3 T_world_base() const;
  [[nodiscard]] PitchState pitch() const;
  [[nodiscard]] WheelTravel travel() const;
  /// At the end of the step: within a millisecond an actor moves less than a range's noise.
  [[nodiscard]] const std::vector<ActorState>& actors() const { return to_.actors; }

 private:
  [[nodiscard]] double interpolate(double from, double to) const {
    return from + fraction_ * (to - from);
  }

  const Step& from_;
  const Step& to_;
  double fraction_;
};

/// The last steps of the simulation: 100 ms and the lag of a device, so that a whole mirror
/// revolution can be measured after it is over. Steps end at full milliseconds; the first one is at
/// time 0.
class MotionHistory {
 public:
  static constexpr time::Duration kStep = 1ms;

  /// Adds the step that ends at `instant`, kStep after the last one. The caller fills it in.
  [[nodiscard]] Step& add(time::SteadyTime instant);

  /// When the last step ended.
  [[nodiscard]] time::SteadyTime newest() const { return newest_; }
  /// The earliest time for at(), if the simulation began before.
  [[nodiscard]] time::SteadyTime oldest() const {
    return newest_ - static_cast<std::int64_t>(kNumSteps - 2) * kStep;
  }

  /// The state at a time from oldest() to newest(), not before 0. Valid until the next add().
  [[nodiscard]] Moment at(time::SteadyTime instant) const;

 private:
  static constexpr std::size_t kNumSteps = 128;

  /// The number of the last step that ended by this time; the start is number 0.
  [[nodiscard]] static std::int64_t number(time::SteadyTime instant) {
    return instant.time_since_epoch() / kStep;
  }
  [[nodiscard]] static std::size_t index(time::SteadyTime instant) {
    return static_cast<std::size_t>(number(instant)) % kNumSteps;
  }

  time::SteadyTime newest_{};
  std::array<Step, kNumSteps> steps_;
};

}  // namespace nodmap::sim
