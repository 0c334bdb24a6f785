// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

#include "common/geometry/se2.hpp"
#include "sim/body/params.hpp"

namespace nodmap::sim {

struct WheelSpeeds {
  double left_mps = 0.0;
  double right_mps = 0.0;
};

/// Distance that the wheels' rims have moved since the start, including slip, as measured by
/// encoders.
struct WheelTravel {
  double left_m = 0.0;
  double right_m = 0.0;
};

/// Motion model of the KURT's skid-steered base: the three wheels of a side rotate together and
/// skid in curves. It knows no obstacles; call block() at contact.
class SkidSteerBase {
 public:
  SkidSteerBase(const DriveParams& params, const geometry::SE2& T_world_start, std::uint64_t seed);

  /// Sets the goal of the wheel speeds. The motors follow it within the limits of lag, power, mass
  /// and friction.
  void set_wheel_speeds(const WheelSpeeds& goal);
  /// Stops as fast as friction allows.
  void brake();

  /// Sets the rise of the ground ahead per metre over ground. Gravity then slows or accelerates the
  /// robot, and the wheels roll farther than the path seen from above.
  void set_slope(double up_ahead) { slope_ = up_ahead; }

  void step(double dt_s);

  /// Keeps the robot at `T_world_base`, blocked by an obstacle, while its wheels slip.
  void block(const geometry::SE2& T_world_base);

  [[nodiscard]] const geometry::SE2& T_world_base() const { return T_world_base_; }
  [[nodiscard]] const WheelTravel& travel() const { return travel_; }
  [[nodiscard]] const WheelSpeeds& wheel_speeds() const { return wheels_; }
  [[nodiscard]] double forward_mps() const { return forward_mps_; }
  [[nodiscard]] double yaw_rate_rad_s() const { return yaw_rate_rad_s_; }
  /// Ahead, by the wheels, and to the left, in a curve.
  [[nodiscard]] const Eigen::Vector2d& acceleration_mps2() const { return acceleration_mps2_; }
  /// Tilt of the body on its tyres and on uneven ground: front up, left side down.
  [[nodiscard]] double tilt_up_rad() const { return tilt_up_rad_ + ground_up_.value; }
  [[nodiscard]] double tilt_left_rad() const { return tilt_left_rad_ + ground_left_.value; }

 private:
  /// A value that varies randomly about zero with the distance driven (Ornstein-Uhlenbeck).
  struct RandomProcess {
    double sigma = 0.0;
    double value = 0.0;
  };
  /// True distance divided by the counted one.
  struct WheelScales {
    double left = 1.0;
    double right = 1.0;
  };

  void accelerate_wheel(double goal_mps, double dt_s, double& wheel_mps) const;
  void advance_random_processes(double distance_m);
  void move(double dt_s);
  void tilt(double dt_s, const WheelSpeeds& before);

  DriveParams params_;
  WheelSpeeds goal_;
  WheelSpeeds wheels_;
  WheelTravel travel_;
  bool is_braking_ = false;
  geometry::SE2 T_world_base_;
  double forward_mps_ = 0.0;
  double yaw_rate_rad_s_ = 0.0;
  Eigen::Vector2d acceleration_mps2_ = Eigen::Vector2d::Zero();
  double tilt_up_rad_ = 0.0;
  double tilt_left_rad_ = 0.0;
  double slope_ = 0.0;
  WheelScales scales_;
  RandomProcess slip_distance_;  // m per m
  RandomProcess slip_heading_;   // rad per m
  RandomProcess slip_turning_;   // rad per rad
  RandomProcess ground_up_;      // rad
  RandomProcess ground_left_;    // rad
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
  // A generator of its own, so that the ground does not affect the slip.
  std::mt19937_64 ground_engine_;
  std::normal_distribution<double> ground_normal_;
};

}  // namespace nodmap::sim
