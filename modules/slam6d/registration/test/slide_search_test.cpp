// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration/slide_search.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace slide_search_test {

using geometry::SE3;

// Of the position along each axis: pilasters must halve it, and a bare corridor leaves all of it.
constexpr double kPriorSigmaM = 0.3;

// The prior after an interruption.
PosePrior interrupted_prior(const SE3& T_map_base) {
  PosePrior prior{T_map_base, Matrix6d::Zero()};
  prior.covariance.diagonal() << Eigen::Vector3d::Constant(kPriorSigmaM * kPriorSigmaM),
      Eigen::Vector3d::Constant(std::pow(geometry::deg_to_rad(8.0), 2));
  return prior;
}

// The sweep of a robot that has rolled on by so much without odometry.
Registration registered_after(double rolled_m, const Room& room) {
  const TestMap map(room, {pose(-1.0, 0.0, 0.0), pose(0.0, 0.0, 0.0)});
  VoxelMap sweep = sweep_at(room, pose(rolled_m, 0.0, 0.0), 9);
  return register_sweep_sliding(sweep, map.voxels, interrupted_prior(SE3::Identity()), {});
}

double sigma_along_m(const Registration& found) {
  return std::sqrt(found.covariance(0, 0));
}

// Pilasters 12 cm deep, as far from each other as doors.
TEST(SlideSearch, PilastersOfACorridorShowHowFarTheRobotRolledOn) {
  Room room = Room::corridor();
  room.boxes = {{Eigen::Vector3d(0.8, 0.98, 0.0), Eigen::Vector3d(1.8, 1.2, 2.5)},
                {Eigen::Vector3d(-2.6, 0.98, 0.0), Eigen::Vector3d(-1.6, 1.2, 2.5)},
                {Eigen::Vector3d(1.5, -1.0, 0.0), Eigen::Vector3d(2.5, -0.78, 2.5)}};
  for (const double rolled_m : {0.0, 0.15, 0.25, 0.5, -0.3}) {
    const Registration found = registered_after(rolled_m, room);
    ASSERT_TRUE(found.is_accepted()) << rolled_m;
    const double error_m = std::abs(found.T_map_base.translation().x() - rolled_m);
    // The beams are 2 degrees apart, 7 cm at 2 m. Registration alone claims to know the place
    // better than that.
    EXPECT_LT(error_m, 0.05) << rolled_m;
    EXPECT_LT(error_m, 3.0 * sigma_along_m(found)) << rolled_m;
    EXPECT_LT(sigma_along_m(found), 0.5 * kPriorSigmaM) << rolled_m;
  }
}

TEST(SlideSearch, InABareCorridorTheCovarianceContainsTheDistance) {
  for (const double rolled_m : {0.25, 0.5}) {
    const Registration found = registered_after(rolled_m, Room::corridor());
    EXPECT_EQ(found.state, PoseState::kDegraded) << rolled_m;
    EXPECT_GT(sigma_along_m(found), 0.99 * kPriorSigmaM) << rolled_m;
    EXPECT_LT(std::abs(found.T_map_base.translation().x() - rolled_m), 3.0 * sigma_along_m(found))
        << rolled_m;
  }
}

// A map that ends 4 m ahead, as where a corridor is mapped for the first time. The sweep sees walls
// farther on.
TEST(SlideSearch, TheEndOfTheMapDoesNotHoldTheRobotBack) {
  VoxelMap map{VoxelMapParams{}};
  SweepCloud mapped = cloud_at(Room::corridor(), SE3::Identity(), 1);
  std::erase_if(mapped.points, [](const Eigen::Vector3f& p) { return std::abs(p.x()) > 4.0F; });
  map.add_sweep(VoxelMap::from_points(mapped.points, mapped.p_base_mirror(), {}), SE3::Identity());
  VoxelMap sweep = sweep_at(Room::corridor(), pose(3.0, 0.0, 0.0), 9);
  const PosePrior prior = interrupted_prior(pose(3.0, 0.0, 0.0));
  const Registration found = register_sweep_sliding(sweep, map, prior, {});
  ASSERT_TRUE(found.is_accepted());
  EXPECT_NEAR(found.T_map_base.translation().x(), 3.0, 0.01 * kPriorSigmaM);
  EXPECT_LT(found.covariance(0, 0), 1.01 * prior.covariance(0, 0));
}

}  // namespace slide_search_test
}  // namespace nodmap::slam6d
