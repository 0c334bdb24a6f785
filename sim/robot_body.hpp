// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>

#include "common/geometry/se2.hpp"
#include "sim/plant_params.hpp"

namespace nodmap::sim {

struct WheelSpeeds {
  double left_mps = 0.0;
  double right_mps = 0.0;
};

/// Way that the wheels' rims have turned since the start, slip included, as the encoders see it.
struct WheelTravel {
  double left_m = 0.0;
  double right_m = 0.0;
};

/// The base of the KURT, skid-steered: three wheels a side turn together and skid in turns. Knows
/// nothing of obstacles; who does calls hold_back().
class RobotBody {
 public:
  RobotBody(const PlantParams& params, const geometry::SE2& T_world_start, std::uint64_t seed);

  void set_wheel_speeds(const WheelSpeeds& goal);
  void brake();

  void step(double dt_s);

  /// Something is in the way: the robot stays at `T_world_base` while its wheels slip.
  void hold_back(const geometry::SE2& T_world_base);

  /// T_world_base.
  [[nodiscard]] const geometry::SE2& pose() const { return T_world_base_; }
  [[nodiscard]] const WheelTravel& travel() const { return travel_; }
  [[nodiscard]] const WheelSpeeds& wheel_speeds() const { return wheels_; }
  [[nodiscard]] double forward_mps() const { return forward_mps_; }
  [[nodiscard]] double yaw_rate_rad_s() const { return yaw_rate_rad_s_; }
  /// How the body leans on its tyres: up at the front, down at the left.
  [[nodiscard]] double lean_up_rad() const { return lean_up_rad_; }
  [[nodiscard]] double lean_left_rad() const { return lean_left_rad_; }

 private:
  /// A share that wanders about zero while the wheels turn.
  struct Wander {
    double sigma = 0.0;
    double value = 0.0;
  };

  void turn_wheel(double goal_mps, double dt_s, double& wheel_mps) const;
  void wander(double way_m);
  void move(double dt_s);
  void lean(double dt_s, const WheelSpeeds& before);

  PlantParams params_;
  WheelSpeeds goal_;
  WheelSpeeds wheels_;
  WheelTravel travel_;
  bool braking_ = false;
  geometry::SE2 T_world_base_;
  double forward_mps_ = 0.0;
  double yaw_rate_rad_s_ = 0.0;
  double lean_up_rad_ = 0.0;
  double lean_left_rad_ = 0.0;
  Wander slip_distance_;  // m for m
  Wander slip_heading_;   // rad for m
  Wander slip_turn_;      // rad for rad
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

}  // namespace nodmap::sim
