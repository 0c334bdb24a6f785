// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/geometry/se3.hpp"
#include "sim/pitch_servo.hpp"
#include "sim/plant_params.hpp"
#include "sim/rangefinder.hpp"
#include "sim/robot_body.hpp"
#include "sim/world.hpp"

namespace nodmap::sim {

/// How things really are.
struct Truth {
  geometry::SE3 T_world_base = geometry::SE3::Identity();
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
  double pitch_rad = 0.0;
  double pitch_rate_rad_s = 0.0;
  double clearance_m = 0.0;
  std::int64_t collisions = 0;
  std::int64_t bumps = 0;
  std::vector<ActorState> actors;
};

/// What the devices are bolted to: the robot in its world. Everything the devices measure or move
/// goes through here, nothing of a protocol is known here. Times are microseconds since the
/// simulation's start; the same world, parameters, seed and calls give the same numbers.
class Plant {
 public:
  Plant(const World& world, const PlantParams& params, std::uint64_t seed);
  ~Plant();
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;
  Plant(Plant&&) = delete;
  Plant& operator=(Plant&&) = delete;

  /// Moves robot, head and actors on to `now_us`, in steps of a millisecond. Never back.
  void advance_to(std::int64_t now_us);
  [[nodiscard]] std::int64_t now_us() const;

  // The laser. One beam at `angle_rad` in the laser plane (0 ahead, positive left), fired at
  // `time_us`: up to 100 ms ago, so that a whole turn of the mirror can be measured beam by beam
  // after it.
  [[nodiscard]] Echo measure(double angle_rad, std::int64_t time_us);

  // The pitch servo.
  void set_pitch_goal(const PitchGoal& goal);
  void set_pitch_torque(bool on);
  /// A gear that is blocked: it does not move whatever it is told.
  void jam_pitch(bool jammed);
  [[nodiscard]] double pitch_rad() const;
  [[nodiscard]] double pitch_rate_rad_s() const;

  // The base. The motors' controllers follow the speeds as well as motors, mass and grip allow.
  void set_wheel_speeds(const WheelSpeeds& goal);
  /// Motors short-circuited: as fast a stop as the grip allows.
  void brake_wheels();
  [[nodiscard]] const WheelTravel& wheel_travel() const;
  [[nodiscard]] WheelSpeeds wheel_speeds() const;

  [[nodiscard]] Truth truth() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace nodmap::sim
