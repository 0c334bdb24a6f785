// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/odometry_prior.hpp"

#include <gtest/gtest.h>

namespace nodmap::slam6d {
namespace odometry_prior_test {

using geometry::SE3;

TEST(OdometryPrior, GrowsWithTheMotion) {
  const OdometryParams params;
  const Matrix6d still = odometry_covariance(SE3::Identity(), {}, params);
  const Matrix6d moved =
      odometry_covariance(SE3::Identity(), {.distance_m = 2.0, .rotation_rad = 0.5}, params);
  EXPECT_NEAR(still(0, 0), std::pow(params.translation_m, 2), 1e-15);
  const double translation_m =
      params.translation_m + 2.0 * params.translation_m_per_m + 0.5 * params.translation_m_per_rad;
  EXPECT_NEAR(moved(0, 0), translation_m * translation_m, 1e-15);
  const double yaw_rad =
      params.rotation_rad + 2.0 * params.yaw_rad_per_m + 0.5 * params.yaw_rad_per_rad;
  EXPECT_NEAR(moved(5, 5), yaw_rad * yaw_rad, 1e-15);
}

TEST(OdometryPrior, EachLostSweepDoublesTheUncertaintyUpToALimit) {
  const auto sigma = [](int lost_sweeps) {
    return std::sqrt(odometry_covariance(SE3::Identity(), {.lost_sweeps = lost_sweeps}, {})(0, 0));
  };
  EXPECT_NEAR(sigma(1), 2.0 * sigma(0), 1e-12);
  EXPECT_NEAR(sigma(3), 8.0 * sigma(0), 1e-12);
  EXPECT_EQ(sigma(50), sigma(100));
  const Matrix6d interrupted = odometry_covariance(SE3::Identity(), {.is_interrupted = true}, {});
  EXPECT_GT(interrupted(0, 0), std::pow(OdometryParams{}.interruption_m, 2));
}

// The covariance is in the axes of map. For a base that is pitched by 90 degrees, a rotation about
// the x axis of map is yaw, and a rotation about its z axis is roll.
TEST(OdometryPrior, IsInTheAxesOfTheMap) {
  SE3 T_map_base = SE3::Identity();
  T_map_base.linear() =
      Eigen::AngleAxisd(0.5 * geometry::kPi, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const OdometryMotion motion{.rotation_rad = 1.0};
  const Matrix6d level = odometry_covariance(SE3::Identity(), motion, {});
  const Matrix6d upended = odometry_covariance(T_map_base, motion, {});
  EXPECT_NEAR(upended(3, 3), level(5, 5), 1e-12);  // base's z is along x of map
  EXPECT_NEAR(upended(5, 5), level(3, 3), 1e-12);
}

// Up to 20 standard deviations of the height the robot may be on the ground floor. On a slope or
// another storey roll and pitch count 25 times less, whether it is above or below; the height,
// which the kernel ignores there, is left alone.
TEST(OdometryPrior, LevelGroundCountsLittleOnAnotherStorey) {
  const OdometryParams params;
  const auto ground_at = [&params](double height_m) {
    SE3 T_map_base = SE3::Identity();
    T_map_base.translation().z() = height_m;
    return level_ground_at(T_map_base, params);
  };
  for (const double height_m : {0.0, 0.09, -0.09}) {
    EXPECT_EQ(ground_at(height_m).tilt_sigma_rad, params.level_tilt_rad) << height_m;
  }
  for (const double height_m : {0.11, -0.11, 3.0}) {
    EXPECT_NEAR(ground_at(height_m).tilt_sigma_rad, 5.0 * params.level_tilt_rad, 1e-12) << height_m;
    EXPECT_EQ(ground_at(height_m).height_sigma_m, params.level_height_m) << height_m;
  }
}

}  // namespace odometry_prior_test
}  // namespace nodmap::slam6d
