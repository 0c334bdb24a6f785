// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/skid_steer_base.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace nodmap::sim {
namespace skid_steer_base_test {

constexpr double kDt = 1e-3;

DriveParams without_slip() {
  DriveParams params;
  params.slip_distance_m = 0.0;
  params.slip_heading_rad = 0.0;
  params.slip_turning_rad = 0.0;
  return params;
}

void run(SkidSteerBase& body, double duration_s) {
  for (int i = 0; i < static_cast<int>(std::lround(duration_s / kDt)); ++i) {
    body.step(kDt);
  }
}

TEST(SkidSteerBase, NeverExceedsTopSpeed) {  // R6
  for (const double bias : {-0.2, 0.0, 0.2}) {
    DriveParams params;  // with slip
    params.odometry_scale_bias = bias;
    SkidSteerBase body(params, {}, 1);
    body.set_wheel_speeds({100.0, 100.0});
    double fastest = 0.0;
    geometry::SE2 before = body.T_world_base();
    for (int i = 0; i < 30'000; ++i) {
      body.step(kDt);
      const geometry::SE2 now = body.T_world_base();
      const double distance_m = (now.translation() - before.translation()).norm();
      fastest = std::max({fastest, distance_m / kDt, body.wheel_speeds().left_mps});
      before = now;
    }
    EXPECT_LE(fastest, 5.2 + 1e-9);
    EXPECT_GT(fastest, 4.0);
  }
}

TEST(SkidSteerBase, ThePowerOfTheMotorsLimitsTheAcceleration) {
  const DriveParams params = without_slip();
  SkidSteerBase body(params, {}, 1);
  body.set_wheel_speeds({5.2, 5.2});
  double energy_j = 0.0;
  double t = 0.0;
  while (t < 1.0) {
    body.step(kDt);
    t += kDt;
    energy_j = 0.5 * params.mass_kg * body.forward_mps() * body.forward_mps();
    // At most the energy that two motors supply, and that of one step more.
    EXPECT_LE(energy_j, 2.0 * params.motor_power_w * (t + kDt));
  }
  EXPECT_GT(energy_j, 0.5 * 2.0 * params.motor_power_w);  // the motors do supply power
}

TEST(SkidSteerBase, TheBrakingDistanceIsThatOfFullGrip) {
  const DriveParams params = without_slip();
  for (const double v : {0.5, 1.5, 4.0}) {
    SkidSteerBase body(params, {}, 1);
    body.set_wheel_speeds({v, v});
    run(body, 20.0);
    ASSERT_NEAR(body.forward_mps(), v, 1e-9);  // rounding
    const double start_m = body.T_world_base().x;
    body.brake();
    run(body, 5.0);
    EXPECT_EQ(body.forward_mps(), 0.0);
    // Tolerance: the distance of one step of 1 ms, v dt.
    EXPECT_NEAR(body.T_world_base().x - start_m, v * v / (2.0 * params.friction * 9.81), v * kDt);
  }
}

TEST(SkidSteerBase, NeverChangesSpeedFasterThanGripAllows) {
  const DriveParams params = without_slip();
  SkidSteerBase body(params, {}, 1);
  double before = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double goal = i / 500 % 2 == 0 ? 3.0 : -3.0;
    body.set_wheel_speeds({goal, goal});
    body.step(kDt);
    const double now = body.wheel_speeds().left_mps;
    ASSERT_LE(std::abs(now - before), params.friction * 9.81 * kDt + 1e-12);
    before = now;
  }
}

TEST(SkidSteerBase, FollowsACommandWithAFirstOrderLag) {
  const DriveParams params = without_slip();
  SkidSteerBase body(params, {}, 1);
  body.set_wheel_speeds({0.1, 0.1});  // so slow that no limit applies
  run(body, params.motor_lag_s);
  // 1 - 1/e; Euler's method in steps of 1 ms has an error of one percent over 50 ms.
  EXPECT_NEAR(body.wheel_speeds().left_mps, 0.1 * (1.0 - std::exp(-1.0)), 0.001);
}

// Odometry as in the driver: an arc for each encoder period.
geometry::SE2 odometry(SkidSteerBase& body, const DriveParams& params, double duration_s) {
  geometry::SE2 pose;
  WheelTravel before = body.travel();
  for (double t = 0.0; t < duration_s; t += 0.01) {
    run(body, 0.01);
    const WheelTravel now = body.travel();
    const double left_m = now.left_m - before.left_m;
    const double right_m = now.right_m - before.right_m;
    const double turn_rad = (right_m - left_m) / params.axis_length_m * params.turning_adaptation;
    const double distance_m = 0.5 * (left_m + right_m);
    pose = pose * geometry::SE2{distance_m * std::cos(0.5 * turn_rad),
                                distance_m * std::sin(0.5 * turn_rad), turn_rad};
    before = now;
  }
  return pose;
}

TEST(SkidSteerBase, CalibratedOdometryIsUnbiased) {
  const DriveParams params = without_slip();
  SkidSteerBase body(params, {}, 1);
  body.set_wheel_speeds({0.4, 0.6});
  const geometry::SE2 estimate = odometry(body, params, 10.0);
  // Odometry takes the chord of each arc of 10 ms: 1.6 um in 5 m.
  EXPECT_NEAR(estimate.x, body.T_world_base().x, 2e-6);
  EXPECT_NEAR(estimate.y, body.T_world_base().y, 2e-6);
  EXPECT_NEAR(estimate.yaw, body.T_world_base().yaw, 1e-9);
  EXPECT_GT(std::abs(estimate.yaw), 1.0);
}

TEST(SkidSteerBase, AScaleBiasLengthensTheMeasuredTravel) {
  DriveParams params = without_slip();
  params.odometry_scale_bias = 0.03;
  SkidSteerBase body(params, {}, 1);
  body.set_wheel_speeds({1.0, 1.0});
  run(body, 10.0);
  EXPECT_NEAR(body.travel().left_m / body.T_world_base().x, 1.03, 1e-9);
}

// A wheel that measures too much also does so in rotations.
TEST(SkidSteerBase, AScaleBiasAlsoActsOnRotations) {
  DriveParams params = without_slip();
  params.odometry_scale_bias = 0.03;
  SkidSteerBase body(params, {}, 1);
  body.set_wheel_speeds({-0.1, 0.1});
  run(body, 2.0);
  const double counted_rad = (body.travel().right_m - body.travel().left_m) / params.axis_length_m *
                             params.turning_adaptation;
  EXPECT_GT(counted_rad, 0.9);
  EXPECT_NEAR(counted_rad / body.T_world_base().yaw, 1.03, 1e-9);
}

// If the left wheels measure 1 % too much and the right ones 1 % too little, a drive that measures
// as straight is an arc to the left: a difference of 0.02 m per m over the axis length, reduced by
// skidding.
TEST(SkidSteerBase, UnequalWheelsMakeTheRobotDriveAnArc) {
  DriveParams params = without_slip();
  params.odometry_scale_difference = 0.02;
  SkidSteerBase body(params, {}, 1);
  body.set_wheel_speeds({1.0, 1.0});
  run(body, 3.0);
  const double expected_rad = body.travel().left_m * (1.0 / 0.99 - 1.0 / 1.01) /
                              params.axis_length_m * params.turning_adaptation;
  EXPECT_NEAR(body.T_world_base().yaw, expected_rad, 1e-9);
}

TEST(SkidSteerBase, GroundTiltHasTheStatedDeviationAndNoMean) {
  const DriveParams params;
  SkidSteerBase body(params, {}, 3);
  body.set_wheel_speeds({0.5, 0.5});
  run(body, 10.0);  // without acceleration from here on
  double sum = 0.0;
  double sum_sq = 0.0;
  constexpr int kSteps = 1'000'000;  // 500 m
  for (int i = 0; i < kSteps; ++i) {
    body.step(kDt);
    sum += body.tilt_up_rad();
    sum_sq += body.tilt_up_rad() * body.tilt_up_rad();
  }
  // 500 m with a correlation of 0.2 m are 1250 independent values: the standard error of the mean
  // is 3 % of the deviation, that of the deviation 2 %. The tolerance is four times that.
  EXPECT_NEAR(sum / kSteps, 0.0, 0.12 * params.ground_tilt_rad);
  EXPECT_NEAR(std::sqrt(sum_sq / kSteps) / params.ground_tilt_rad, 1.0, 0.08);
}

TEST(SkidSteerBase, SlipIsARandomWalkOfTheStatedSize) {
  const DriveParams params;
  double sum_distance_sq = 0.0;
  double sum_yaw_sq = 0.0;
  constexpr int kRuns = 400;
  double travel_m = 0.0;
  for (int seed = 0; seed < kRuns; ++seed) {
    SkidSteerBase body(params, {}, static_cast<std::uint64_t>(seed));
    body.set_wheel_speeds({1.0, 1.0});
    run(body, 9.0);
    travel_m = body.travel().left_m;
    // Compared with the length of the true path, not with x: headings of a few degrees always make
    // x a few tenths of a percent shorter.
    const double distance_m = std::hypot(body.T_world_base().x, body.T_world_base().y);
    sum_distance_sq += (distance_m - travel_m) * (distance_m - travel_m);
    sum_yaw_sq += body.T_world_base().yaw * body.T_world_base().yaw;
  }
  // The deviation of 400 runs has a standard error of 1/sqrt(800) = 3.5 %; the tolerance is four
  // times that. A correlation of 0.2 m in 9 m takes away 1 %.
  EXPECT_NEAR(std::sqrt(sum_yaw_sq / kRuns) / (params.slip_heading_rad * std::sqrt(travel_m)), 1.0,
              0.15);
  EXPECT_NEAR(std::sqrt(sum_distance_sq / kRuns) / (params.slip_distance_m * std::sqrt(travel_m)),
              1.0, 0.15);
}

TEST(SkidSteerBase, SlipInRotationsIsARandomWalkOfTheStatedSize) {
  const DriveParams params;
  double sum_sq = 0.0;
  double turned_rad = 0.0;
  constexpr int kRuns = 400;
  for (int seed = 0; seed < kRuns; ++seed) {
    SkidSteerBase body(params, {}, static_cast<std::uint64_t>(seed));
    body.set_wheel_speeds({-0.5, 0.5});
    double yaw_rad = 0.0;
    for (int i = 0; i < 10'000; ++i) {
      body.step(kDt);
      yaw_rad += body.yaw_rate_rad_s() * kDt;
    }
    turned_rad = 2.0 * body.travel().right_m / params.axis_length_m * params.turning_adaptation;
    sum_sq += (yaw_rad - turned_rad) * (yaw_rad - turned_rad);
  }
  // As above; a correlation of 1 rad in 25 rad takes away 2 % more.
  EXPECT_NEAR(std::sqrt(sum_sq / kRuns) / (params.slip_turning_rad * std::sqrt(turned_rad)), 1.0,
              0.16);
}

// Slip with standard deviation s per root of rad and correlation length l, in the middle of a
// drive: the variance after a rotation a is s^2 (a - l (1 - exp(-a / l))).
TEST(SkidSteerBase, SlipInARotationOfOneRadIsSmallerThanByTheRoot) {
  const DriveParams params;
  const double rad_per_m = 2.0 / params.axis_length_m * params.turning_adaptation;
  double sum_sq = 0.0;
  constexpr int kRuns = 400;
  for (int seed = 0; seed < kRuns; ++seed) {
    SkidSteerBase body(params, {}, static_cast<std::uint64_t>(seed));
    body.set_wheel_speeds({-0.5, 0.5});
    run(body, 2.0);  // five correlation lengths
    const double begin_m = body.travel().right_m;
    double error_rad = 0.0;
    while (rad_per_m * (body.travel().right_m - begin_m) < 1.0) {
      const double before_m = body.travel().right_m;
      body.step(kDt);
      error_rad += body.yaw_rate_rad_s() * kDt - rad_per_m * (body.travel().right_m - before_m);
    }
    sum_sq += error_rad * error_rad;
  }
  const double length_rad = 0.2 * rad_per_m;
  const double expected_rad =
      params.slip_turning_rad * std::sqrt(1.0 - length_rad * (1.0 - std::exp(-1.0 / length_rad)));
  EXPECT_NEAR(geometry::rad_to_deg(expected_rad), 1.2, 0.05);  // as sim/README.md says
  // Four standard errors of the deviation of 400 runs.
  EXPECT_NEAR(std::sqrt(sum_sq / kRuns) / expected_rad, 1.0, 0.15);
}

TEST(SkidSteerBase, StationaryWheelsDoNotSlip) {
  SkidSteerBase body({}, {1.0, 2.0, 0.5}, 1);
  run(body, 10.0);
  EXPECT_EQ(body.travel().left_m, 0.0);
  EXPECT_EQ(body.T_world_base().x, 1.0);
  EXPECT_EQ(body.T_world_base().yaw, 0.5);
}

}  // namespace skid_steer_base_test
}  // namespace nodmap::sim
