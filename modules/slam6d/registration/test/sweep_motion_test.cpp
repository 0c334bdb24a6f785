// SPDX-License-Identifier: BSD-3-Clause
// The prior of a sweep that is measured while the robot moves.
#include "modules/slam6d/registration/sweep_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "modules/slam6d/registration/heading_search.hpp"
#include "modules/slam6d/test/hall.hpp"
#include "modules/slam6d/tracking/odometry_prior.hpp"

namespace nodmap::slam6d {
namespace sweep_motion_test {

using geometry::SE3;

SweepCloud sweep_of(const Motion& T_world_base, const Motion& T_odom_base, unsigned seed) {
  std::mt19937 random(seed);
  const NoddingScanner scanner{.noise_m = 0.01};
  std::vector<scan::Scan> scans;
  for (int i = 0; i < 80; ++i) {
    scans.push_back(scanner.scan(i, Room::hall(), T_world_base, random));
  }
  return deskew(scans, T_odom_base, {.max_m = 15.0}).value();
}

// The heading of odometry is off by one standard deviation when a sweep at 1 m/s begins; its motion
// within the sweep is exact, from wheels that are known well. So the pose is one standard deviation
// from the prior, to which the noise of the sweep adds less than a tenth.
TEST(SweepMotion, AWrongHeadingOfAMovingRobotIsChargedOnce) {
  const Motion stays = [](time::Timestamp) { return SE3::Identity(); };
  VoxelMap map{VoxelMapParams{}};
  map.add_sweep(voxelize(sweep_of(stays, stays, 1), {}), SE3::Identity());
  const Motion drive = [](time::Timestamp t) { return drive_ahead(1.0, t); };
  for (const double off_deg : {5.0, 12.0, 24.0}) {
    const Motion odometry = [&](time::Timestamp t) { return pose(0.0, 0.0, off_deg) * drive(t); };
    const SweepCloud cloud = sweep_of(drive, odometry, 8);
    VoxelMap sweep = voxelize(cloud, {});
    PosePrior prior{.T_map_base = odometry(cloud.stamp), .covariance = Matrix6d::Zero()};
    const double sigma_rad = geometry::deg_to_rad(off_deg);
    prior.covariance.diagonal() << 0.0025, 0.0025, 0.0025, 1e-4, 1e-4, sigma_rad * sigma_rad;
    prior.motion_covariance = odometry_covariance(
        prior.T_map_base, {.distance_m = cloud.motion().translation().norm(), .scatter = 0.2}, {});
    const Registration found = register_sweep(sweep, map, prior, {});
    ASSERT_TRUE(found.is_accepted()) << off_deg;
    EXPECT_NEAR(found.prior_distance, 1.0, 0.1) << off_deg;
    EXPECT_LT(geometry::distance_m(found.T_map_base, drive(cloud.stamp)), 0.01) << off_deg;
  }
}

}  // namespace sweep_motion_test
}  // namespace nodmap::slam6d
