// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "sim/body/contact_counts.hpp"
#include "sim/body/params.hpp"
#include "sim/body/pitch_servo.hpp"
#include "sim/body/rangefinder.hpp"
#include "sim/body/skid_steer_base.hpp"
#include "sim/world/world.hpp"

namespace nodmap::sim {

/// The true state of robot and actors.
struct GroundTruth {
  geometry::SE3 T_world_base = geometry::SE3::Identity();
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
  Eigen::Vector2d acceleration_mps2 = Eigen::Vector2d::Zero();  ///< ahead and to the left
  double pitch_rad = 0.0;
  double pitch_rate_rad_s = 0.0;
  double clearance_m = 0.0;         ///< from the body to the nearest obstacle or actor
  double person_clearance_m = 0.0;  ///< from the body to the nearest actor; infinite without
  ContactCounts contacts;
  std::vector<ActorState> actors;
};

/// The robot in its world without electronics or protocols. The devices measure and move through
/// this class. Time starts at 0 with the simulation; the same world, parameters, seed and calls
/// give the same numbers.
class RobotModel {
 public:
  RobotModel(const World& world, const RobotModelParams& params, std::uint64_t seed);
  ~RobotModel();

  /// Advances robot, laser and actors to `now`, in steps of a millisecond. Throws
  /// std::invalid_argument if the time goes back.
  void advance_to(time::SteadyTime now);
  [[nodiscard]] time::SteadyTime now() const;

  /// Measures one beam at `angle_rad` in the laser's plane (0 ahead, positive left), as it was when
  /// it was fired: up to 100 ms ago, so that a whole mirror revolution can be measured afterwards.
  /// Throws std::out_of_range for other times.
  [[nodiscard]] Echo measure(double angle_rad, time::SteadyTime fired);

  void set_pitch_goal(const PitchGoal& goal);
  void set_pitch_torque(bool on);
  /// Jams or frees the servo's gear; a jammed one does not move.
  void set_pitch_jammed(bool jammed);
  [[nodiscard]] double pitch_rad() const;
  [[nodiscard]] double pitch_rate_rad_s() const;

  /// Sets the goal of the wheel speeds. The motors follow it within the limits of lag, power, mass
  /// and friction.
  void set_wheel_speeds(const WheelSpeeds& goal);
  /// Short-circuits the motors: stops as fast as friction allows.
  void brake_wheels();
  [[nodiscard]] const WheelTravel& wheel_travel() const;
  [[nodiscard]] WheelSpeeds wheel_speeds() const;

  /// The present distance from a point on the body (in base) along `yaw_rad` to the first surface
  /// that reflects light, metres; empty if there is none up to `max_range_m`.
  [[nodiscard]] std::optional<double> distance_from(const Eigen::Vector3d& p_base, double yaw_rad,
                                                    double max_range_m) const;

  [[nodiscard]] GroundTruth ground_truth() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace nodmap::sim
