// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/front_end/pose_covariance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "modules/slam2d/test/drawn_world.hpp"
#include "modules/slam2d/test/track.hpp"

namespace nodmap::slam2d {
namespace pose_covariance_test {

using geometry::SE2;

TEST(PoseCovariance, GrowsWithTheDistanceByOdometry) {
  PoseCovariance once;
  once.predict(0.0, {4.0, 0.0, 0.0});
  PoseCovariance in_steps;
  for (int i = 0; i < 400; ++i) {
    in_steps.predict(0.0, {0.01, 0.0, 0.0});
  }
  EXPECT_NEAR(once.matrix()(0, 0), 4.0 * 0.016, 1e-12);
  EXPECT_NEAR(in_steps.matrix()(0, 0), 4.0 * 0.016, 1e-9);
  // An error of the heading moves the rest of the path sideways: over a path of length s, a heading
  // variance of q per metre adds q s^3 / 3.
  EXPECT_NEAR(in_steps.matrix()(1, 1), 4.0 * 0.016 + 0.004 * 64.0 / 3.0, 2e-3);
  PoseCovariance stationary;
  stationary.predict(1.0, {});
  EXPECT_TRUE(stationary.matrix().isZero(0.0));
}

// Known 10 times less well along x than along y, before the map is turned left by 90 degrees.
TEST(PoseCovariance, RotatesWithTheMap) {
  PoseCovariance covariance;
  covariance.update(Eigen::Vector3d(1.0, 100.0, 400.0).asDiagonal());
  covariance.rotate(std::acos(0.0));
  const Eigen::Matrix3d rotated = Eigen::Vector3d(0.01, 1.0, 0.0025).asDiagonal();
  EXPECT_TRUE(covariance.matrix().isApprox(rotated, 1e-12));
}

TEST(PoseCovariance, TheLeastAndTheGreatestSigmaAreThoseOfTheErrorEllipse) {
  PoseCovariance covariance;
  covariance.update(Eigen::Vector3d(0.25, 100.0, 400.0).asDiagonal());
  covariance.rotate(0.3);
  EXPECT_NEAR(covariance.least_sigma_m(), 0.1, 1e-12);
  EXPECT_NEAR(covariance.greatest_sigma_m(), 2.0, 1e-12);
}

TEST(PoseCovariance, TimeWithoutOdometryAddsAMetreAndARadianASecond) {
  PoseCovariance covariance;
  covariance.lose_track(2.0);
  EXPECT_TRUE(covariance.matrix().isApprox(4.0 * Eigen::Matrix3d::Identity()));
}

TEST(PoseCovariance, AMatchInAllDirectionsSetsTheInverseOfItsInformation) {
  Eigen::Matrix3d information;
  information << 400.0, 20.0, -90.0, 20.0, 900.0, 50.0, -90.0, 50.0, 2500.0;
  PoseCovariance covariance;
  covariance.predict(0.3, {5.0, 0.0, 1.0});
  covariance.update(information);
  EXPECT_TRUE(covariance.matrix().isApprox(information.inverse(), 1e-9));
  covariance.update(information);  // the same match again adds no information
  EXPECT_TRUE(covariance.matrix().isApprox(information.inverse(), 1e-9));
}

TEST(PoseCovariance, ADegenerateDirectionKeepsTheUncertaintyOfOdometry) {
  PoseCovariance covariance;
  covariance.predict(0.0, {5.0, 0.0, 0.0});
  const double along_m2 = covariance.matrix()(0, 0);
  covariance.update(Eigen::Vector3d(0.0, 900.0, 2500.0).asDiagonal());
  EXPECT_NEAR(covariance.matrix()(0, 0), along_m2, 1e-12);
  EXPECT_NEAR(covariance.matrix()(1, 1), 1.0 / 900.0, 1e-12);
  covariance.update(Eigen::Matrix3d::Zero());  // nothing matched: nothing changes
  EXPECT_NEAR(covariance.matrix()(0, 0), along_m2, 1e-12);
}

// The last pose of a drive as it was estimated, and the true one.
struct Outcome {
  PoseUpdate update;
  SE2 truth;
};

// Drives with wheels that count 3 % too much distance, and a heading that drifts.
Outcome drive(const test::FloorPlan& plan, const SE2& step, int steps) {
  test::Slam slam;
  test::Scanner scanner;
  Outcome outcome;
  SE2 odom;
  for (int i = 0; i < steps; ++i) {
    const scan::Scan scan = scanner.scan(plan, outcome.truth, time::Timestamp(test::kPeriod * i));
    outcome.update = track(slam, scan, odom).value();
    if (i + 1 < steps) {
      outcome.truth = outcome.truth * step;
      odom = odom * SE2{1.03 * step.x, 0.0, step.yaw + 0.0005};
    }
  }
  return outcome;
}

TEST(PoseCovariance, InARoomTheCovarianceIsConsistentWithTheError) {
  const Outcome end = drive(test::room(), {0.03, 0.0, 0.04}, 150);
  const Eigen::Vector3d error(end.update.T_map_base.x - end.truth.x,
                              end.update.T_map_base.y - end.truth.y,
                              geometry::angle_difference(end.update.T_map_base.yaw, end.truth.yaw));
  const Eigen::Matrix3d& covariance = end.update.covariance;
  EXPECT_LT(std::sqrt(covariance(0, 0)), 0.1);
  EXPECT_LT(std::sqrt(covariance(2, 2)), 0.05);
  // Chi-squared with three degrees of freedom: one in a thousand is above 16.3.
  EXPECT_LT(error.dot(covariance.inverse() * error), 16.3);
}

TEST(PoseCovariance, AlongACorridorTheCovarianceGrowsAndCoversTheError) {
  const Outcome near = drive(test::corridor(), {0.1, 0.0, 0.0}, 20);
  const Outcome far = drive(test::corridor(), {0.1, 0.0, 0.0}, 200);
  ASSERT_EQ(far.update.state, PoseState::kDegraded);
  const double error_m = std::abs(far.update.T_map_base.x - far.truth.x);
  EXPECT_GT(error_m, 0.5);  // 3 % of 20 m
  EXPECT_GT(std::sqrt(far.update.covariance(0, 0)), error_m / 3.0);
  EXPECT_GT(far.update.covariance(0, 0), 3.0 * near.update.covariance(0, 0));
  EXPECT_LT(std::sqrt(far.update.covariance(1, 1)), 0.3);
}

}  // namespace pose_covariance_test
}  // namespace nodmap::slam2d
