// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/odometry.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace nodmap::kurt {
namespace odometry_test {

constexpr double kPeriodS = 0.01;

// A robot whose ticks are whole millimetres: 1 tick = 1 mm.
WheelParams millimetre_wheels() {
  WheelParams wheels;
  wheels.perimeter_m = 1.0;
  wheels.ticks_per_revolution = 1000;
  wheels.axis_m = 0.3;
  wheels.turning_adaptation = 0.6;
  return wheels;
}

TEST(Odometry, StraightOn) {
  Odometry odometry(millimetre_wheels(), {});
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(odometry.add({10, 10}));
  }
  const OdometryState& state = odometry.state();
  EXPECT_NEAR(state.T_odom_base.x, 1.0, 1e-12);
  EXPECT_EQ(state.T_odom_base.y, 0.0);
  EXPECT_EQ(state.T_odom_base.yaw, 0.0);
  EXPECT_NEAR(state.forward_mps, 1.0, 1e-12);
  EXPECT_EQ(state.yaw_rate_rad_s, 0.0);
}

// perimeter * ticks / ticks_per_revolution; omega = (vR - vL) / axis * turning_adaptation, of
// kurt_driver.
TEST(Odometry, SpeedsAreThoseOfKurtDriver) {
  Odometry odometry(WheelParams{}, {});
  ASSERT_TRUE(odometry.add({200, 300}));
  const double left_mps = 0.379 * 200 / 21950 / kPeriodS;
  const double right_mps = 0.379 * 300 / 21950 / kPeriodS;
  EXPECT_DOUBLE_EQ(odometry.state().forward_mps, 0.5 * (left_mps + right_mps));
  EXPECT_NEAR(odometry.state().yaw_rate_rad_s, (right_mps - left_mps) / 0.28 * 0.69, 1e-12);
}

TEST(Odometry, AFasterLeftWheelTurnsRight) {
  Odometry odometry(millimetre_wheels(), {});
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(odometry.add({11, 10}));
  }
  EXPECT_LT(odometry.state().T_odom_base.yaw, 0.0);
  EXPECT_LT(odometry.state().T_odom_base.y, 0.0);  // right is negative y
  EXPECT_LT(odometry.state().yaw_rate_rad_s, 0.0);
  EXPECT_GT(odometry.state().T_odom_base.x, 0.0);
}

TEST(Odometry, TurningOnTheSpotStaysThere) {
  Odometry odometry(millimetre_wheels(), {});
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(odometry.add({-5, 5}));
  }
  EXPECT_NEAR(odometry.state().T_odom_base.yaw, 10 * 0.010 / 0.3 * 0.6, 1e-12);
  EXPECT_EQ(odometry.state().T_odom_base.x, 0.0);
  EXPECT_EQ(odometry.state().T_odom_base.y, 0.0);
}

// Each step is an exact arc: after any number of steps the pose lies on the circle.
TEST(Odometry, ACircleIsACircle) {
  const WheelParams wheels = millimetre_wheels();
  const OdometryNoiseParams noise;
  Odometry odometry(wheels, noise);
  const double rotation_rad = 0.005 / wheels.axis_m * wheels.turning_adaptation;  // per step
  const double radius_m = 0.0075 / rotation_rad;
  for (int i = 1; i <= 1000; ++i) {
    ASSERT_TRUE(odometry.add({5, 10}));
    const geometry::SE2& pose = odometry.state().T_odom_base;
    // 1000 additions of rounding
    EXPECT_NEAR(pose.x, radius_m * std::sin(rotation_rad * i), 1e-10);
    EXPECT_NEAR(pose.y, radius_m * (1.0 - std::cos(rotation_rad * i)), 1e-10);
    EXPECT_NEAR(pose.yaw, geometry::normalize_angle(rotation_rad * i), 1e-10);
  }
}

TEST(Odometry, BackingUpReturnsToTheStart) {
  Odometry odometry(millimetre_wheels(), {});
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(odometry.add({2, 1}));
  }
  ASSERT_TRUE(odometry.add({0, 0}));
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(odometry.add({-2, -1}));
  }
  EXPECT_NEAR(odometry.state().T_odom_base.x, 0.0, 1e-12);
  EXPECT_NEAR(odometry.state().T_odom_base.y, 0.0, 1e-12);
  EXPECT_NEAR(odometry.state().T_odom_base.yaw, 0.0, 1e-12);
}

TEST(Odometry, LostFramesAreBridgedAndIncreaseTheUncertainty) {
  Odometry whole(millimetre_wheels(), {});
  Odometry bridged(millimetre_wheels(), {});
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(whole.add({10, 14}));
    if (i < 50 || i >= 53) {
      ASSERT_TRUE(bridged.add({10, 14}));
    } else if (i == 50) {
      bridged.bridge(3);
    }
  }
  EXPECT_NEAR(bridged.state().T_odom_base.x, whole.state().T_odom_base.x, 1e-12);
  EXPECT_NEAR(bridged.state().T_odom_base.yaw, whole.state().T_odom_base.yaw, 1e-12);
  EXPECT_GT(bridged.state().covariance(0, 0), whole.state().covariance(0, 0));
  EXPECT_GT(bridged.state().covariance(2, 2), whole.state().covariance(2, 2));
}

TEST(Odometry, AGapKeepsThePoseAndIsUncertain) {
  Odometry odometry(millimetre_wheels(), {});
  ASSERT_TRUE(odometry.add({9, 11}));  // 1 m/s
  const double x_m = odometry.state().T_odom_base.x;
  const double before = odometry.state().covariance(0, 0);
  odometry.bridge_gap(60.0);
  EXPECT_EQ(odometry.state().T_odom_base.x, x_m);
  // Half a second of rolling on at 1 m/s, not a minute.
  EXPECT_NEAR(odometry.state().covariance(0, 0) - before, 0.25, 1e-12);
  EXPECT_EQ(odometry.state().forward_mps, 0.0);
  EXPECT_EQ(odometry.state().yaw_rate_rad_s, 0.0);
}

TEST(Odometry, TicksNoWheelCanMakeAreRefused) {
  Odometry odometry(millimetre_wheels(), {});
  ASSERT_TRUE(odometry.add({10, 10}));
  EXPECT_FALSE(odometry.add({10, 32767}));
  EXPECT_FALSE(odometry.add({-32768, 10}));
  // The two implausible periods are bridged at 1 m/s.
  EXPECT_NEAR(odometry.state().T_odom_base.x, 0.03, 1e-12);
  EXPECT_EQ(odometry.state().T_odom_base.yaw, 0.0);
}

// 30 m/s^2, and a fifth of the speed.
TEST(Odometry, AWheelAcceleratesOnlySoFast) {
  Odometry odometry(millimetre_wheels(), {});
  ASSERT_TRUE(odometry.add({10, 10}));
  EXPECT_TRUE(odometry.is_plausible({15, 5}));
  EXPECT_FALSE(odometry.is_plausible({16, 10}));
  EXPECT_FALSE(odometry.is_plausible({10, 4}));
  odometry.bridge(1);
  EXPECT_TRUE(odometry.is_plausible({20, 0}));  // in two periods
  EXPECT_FALSE(odometry.is_plausible({21, 10}));
  int mm = 10;
  for (; mm < 103; mm += 3) {
    ASSERT_TRUE(odometry.add({mm, mm})) << mm;
  }
  EXPECT_TRUE(odometry.is_plausible({104, 104}));  // 10.4 m/s is the limit
  EXPECT_FALSE(odometry.is_plausible({105, 104}));
}

// A robot that hits a wall stops quicker than any that brakes.
TEST(Odometry, AStopAtOnceIsBelievedAfterSomePeriods) {
  Odometry odometry(millimetre_wheels(), {});
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(odometry.add({15, 15}));
  }
  int refused = 0;
  while (!odometry.add({0, 0})) {
    ++refused;
  }
  EXPECT_EQ(refused, 2);  // 0.6 m/s in each period
  EXPECT_NEAR(odometry.state().T_odom_base.x, 1.5 + 0.03, 1e-12);
}

// Whatever it believed before, two ticks that follow from each other are believed in the end.
TEST(Odometry, FindsBackFromWrongTicks) {
  Odometry odometry(millimetre_wheels(), {});
  for (int mm = 0; mm < 100; mm += 3) {
    ASSERT_TRUE(odometry.add({mm, mm}));
  }
  int refused = 0;
  while (!odometry.is_plausible({-100, -100})) {
    odometry.ignore({-100, -100});
    ASSERT_LT(++refused, 20);
  }
}

// A flipped bit in a digit of the ticks, in four frames of a hundred. SLCAN does not notice it.
TEST(Odometry, DamagedDigitsLeaveThePoseNearlyRight) {
  std::mt19937 random(5);
  std::bernoulli_distribution is_damaged(0.04);
  const WheelParams wheels;
  Odometry odometry(wheels, {});
  constexpr int kTicks = 869;  // 1.5 m/s
  for (int i = 0; i < 6000; ++i) {
    const int speed = std::min({8 * i, kTicks, 8 * (5999 - i)});
    const auto received = [&] {
      return is_damaged(random) ? static_cast<std::int16_t>(speed ^ (1 << (random() % 16))) : speed;
    };
    odometry.add({received(), received()});
  }
  // Between the ramps of 109 periods. Errors of at most 6 mm (a side: 3) in eight of a hundred
  // periods, with a random sign: 6 cm are one sigma. Believing up to 10.4 m/s it was metres.
  const double true_m =
      kTicks * (5999.0 - 109.0) * wheels.perimeter_m / wheels.ticks_per_revolution;
  EXPECT_NEAR(odometry.state().T_odom_base.x, true_m, 0.2);
}

TEST(Odometry, AStationaryRobotStaysCertain) {
  Odometry odometry(millimetre_wheels(), {});
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(odometry.add({0, 0}));
  }
  EXPECT_EQ(odometry.state().covariance, Eigen::Matrix3d::Zero());
}

TEST(Odometry, UncertaintyAfterOneMetreIsAsConfigured) {
  const WheelParams wheels = millimetre_wheels();
  const OdometryNoiseParams noise;
  Odometry odometry(wheels, noise);
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(odometry.add({10, 10}));
  }
  EXPECT_NEAR(std::sqrt(odometry.state().covariance(0, 0)), noise.distance_sigma_m, 1e-12);
  EXPECT_NEAR(std::sqrt(odometry.state().covariance(2, 2)), noise.heading_sigma_rad, 1e-12);
}

// Otherwise a robot that backs up or turns right would be ever more certain of its pose.
TEST(Odometry, UncertaintyIsTheSameBackwardsAndToTheRight) {
  const auto covariance_after = [](const EncoderTicks& ticks) {
    Odometry odometry(millimetre_wheels(), {});
    for (int i = 0; i < 100; ++i) {
      EXPECT_TRUE(odometry.add(ticks));
    }
    return Eigen::Matrix3d(odometry.state().covariance);
  };
  const Eigen::Matrix3d forwards = covariance_after({10, 14});
  for (const EncoderTicks& mirrored : {EncoderTicks{14, 10}, {-10, -14}, {-14, -10}}) {
    const Eigen::Matrix3d covariance = covariance_after(mirrored);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(covariance(i, i), forwards(i, i), 1e-12);
    }
  }
}

// A lost period at 1 m/s: half of its 1 cm is added to the uncertainty of driving it.
TEST(Odometry, ABridgedPeriodIsUncertainByHalfOfItsMotion) {
  const OdometryNoiseParams noise;
  Odometry odometry(millimetre_wheels(), noise);
  ASSERT_TRUE(odometry.add({10, 10}));
  const double before = odometry.state().covariance(0, 0);
  odometry.bridge(1);
  EXPECT_NEAR(odometry.state().covariance(0, 0) - before,
              noise.distance_sigma_m * noise.distance_sigma_m * 0.01 + 0.005 * 0.005, 1e-15);
}

// Within a period the heading is uncertain halfway: the position gets half of that across the path.
TEST(Odometry, TheHeadingsErrorOfAPeriodMovesItsEndAside) {
  OdometryNoiseParams noise;
  noise.rotation_sigma_rad = 0.0;  // rotating on the spot stays certain
  Odometry odometry(millimetre_wheels(), noise);
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(odometry.add({-1, 1}));
  }
  ASSERT_EQ(odometry.state().covariance, Eigen::Matrix3d::Zero());
  ASSERT_TRUE(odometry.add({1, 1}));
  const double yaw_rad = odometry.state().T_odom_base.yaw;
  const Eigen::Matrix3d& covariance = odometry.state().covariance;
  EXPECT_NEAR(covariance(0, 2), -0.0005 * std::sin(yaw_rad) * covariance(2, 2), 1e-15);
  EXPECT_NEAR(covariance(1, 2), 0.0005 * std::cos(yaw_rad) * covariance(2, 2), 1e-15);
}

// Oracle: the sampled covariance of the poses of robots whose wheels slip at random.
TEST(Odometry, CovarianceIsThatOfRobotsThatSlip) {
  const WheelParams wheels = millimetre_wheels();
  const OdometryNoiseParams noise;
  constexpr int kRobots = 4000;
  constexpr int kSteps = 100;
  constexpr double kDistance = 0.012;
  const double rotation_rad = 0.004 / wheels.axis_m * wheels.turning_adaptation;
  const double sigma_distance = noise.distance_sigma_m * std::sqrt(kDistance);
  const double sigma_rotation =
      std::sqrt(noise.heading_sigma_rad * noise.heading_sigma_rad * kDistance +
                noise.rotation_sigma_rad * noise.rotation_sigma_rad * rotation_rad);
  std::mt19937 random(17);
  std::normal_distribution<double> slip;
  std::vector<Eigen::Vector3d> poses;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (int robot = 0; robot < kRobots; ++robot) {
    Eigen::Vector3d pose = Eigen::Vector3d::Zero();
    for (int step = 0; step < kSteps; ++step) {
      const double d = kDistance + sigma_distance * slip(random);
      const double t = rotation_rad + sigma_rotation * slip(random);
      pose +=
          Eigen::Vector3d(d * std::cos(pose.z() + 0.5 * t), d * std::sin(pose.z() + 0.5 * t), t);
    }
    poses.push_back(pose);
    mean += pose / kRobots;
  }
  Eigen::Matrix3d sampled = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& pose : poses) {
    sampled += (pose - mean) * (pose - mean).transpose() / kRobots;
  }
  Odometry odometry(wheels, noise);
  for (int step = 0; step < kSteps; ++step) {
    ASSERT_TRUE(odometry.add({10, 14}));
  }
  const Eigen::Matrix3d& covariance = odometry.state().covariance;
  // 4000 samples give a variance to 2.2 % (one sigma); second order terms add a few per cent.
  EXPECT_LT((covariance - sampled).norm(), 0.1 * sampled.norm()) << covariance << "\n" << sampled;
  EXPECT_TRUE(covariance.isApprox(covariance.transpose(), 1e-12));
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues().minCoeff(),
            0.0);
}

}  // namespace odometry_test
}  // namespace nodmap::kurt
