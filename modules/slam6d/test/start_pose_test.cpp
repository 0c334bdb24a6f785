// SPDX-License-Identifier: BSD-3-Clause
// A robot that is told its pose in a saved map (--start-pose).
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>

#include "modules/slam6d/slam6d.hpp"
#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace start_pose_test {

using geometry::SE3;

// A robot in a saved map of Room::hall().
class RobotInASavedHall : public testing::Test {
 protected:
  RobotInASavedHall() {
    Slam6d mapping({});
    for (const SE3& T_map_base : along_hall()) {
      see(mapping, Room::hall(), T_map_base, T_map_base);
    }
    saved_ = mapping.save();
  }

  PoseUpdate see(Slam6d& slam, const Room& room, const SE3& T_world_base, const SE3& T_odom_base) {
    SweepCloud cloud = cloud_at(room, T_world_base, ++seed_);
    stamp_ += 1s;
    cloud.stamp = stamp_;
    cloud.T_odom_base = T_odom_base;
    cloud.scans_used = 80;
    return slam.add_cloud(std::move(cloud));
  }

  SavedMap saved_;
  unsigned seed_ = 0;
  time::Timestamp stamp_{};
};

// A start pose may be wrong, and where a building repeats itself the first sweep does not show it.
TEST_F(RobotInASavedHall, TheMapIsContinuedOnlyThreeMetresFromTheStartPose) {
  Slam6d slam({});
  slam.restore(saved_, pose(-2.0, 0.0, 0.0), false);
  for (const double x_m : {-2.0, -1.0, 0.0, 0.9}) {
    const SE3 T_map_base = pose(x_m, 0.0, 0.0);
    const PoseUpdate update = see(slam, Room::hall(), T_map_base, T_map_base);
    EXPECT_EQ(update.registration->state, PoseState::kTracking) << x_m;
    EXPECT_EQ(slam.keyframes().size(), saved_.keyframes.size()) << x_m;
  }
  see(slam, Room::hall(), pose(1.1, 0.0, 0.0), pose(1.1, 0.0, 0.0));
  EXPECT_EQ(slam.keyframes().size(), saved_.keyframes.size() + 1);
}

// Odometry counts 5 cm to the side. A sweep that contradicts the map says nothing about the pose.
TEST_F(RobotInASavedHall, ALostPoseIsThatOfOdometry) {
  Slam6d slam({});
  slam.restore(saved_, pose(-2.0, 0.0, 0.0), true);
  see(slam, Room::hall(), pose(-2.0, 0.0, 0.0), pose(-2.0, 0.0, 0.0));
  PoseUpdate update;
  do {
    update = see(slam, look_alike_hall(), pose(-2.0, 0.0, 0.0), pose(-2.0, 0.05, 0.0));
    ASSERT_LT(slam.sweeps().size(), 10U);
  } while (update.is_tracked());
  ASSERT_EQ(slam.localiser()->metrics().times_contradicted, 1);
  EXPECT_TRUE(update.T_map_base.isApprox(update.T_map_odom * update.T_odom_base, 1e-9));
  EXPECT_GT(std::sqrt(update.covariance(1, 1)), 0.01);
}

// Somebody stands before the laser while the robot begins to drive.
TEST_F(RobotInASavedHall, TheStartPoseIsThatOfTheFirstSweepAlsoIfItIsBlind) {
  Slam6d slam({});
  slam.restore(saved_, pose(-2.0, 0.0, 0.0), true);
  const SE3 T_odom_map = pose(7.0, 3.0, 50.0);
  see(slam, box_about_robot(kBlindM), SE3::Identity(), T_odom_map * pose(-2.0, 0.0, 0.0));
  see(slam, box_about_robot(kBlindM), SE3::Identity(), T_odom_map * pose(-1.0, 0.0, 0.0));
  const SE3 T_map_base = pose(0.0, 0.0, 0.0);
  const PoseUpdate update = see(slam, Room::hall(), T_map_base, T_odom_map * T_map_base);
  ASSERT_TRUE(update.is_tracked());
  EXPECT_LT((update.T_map_base.translation() - T_map_base.translation()).norm(), 0.01);
}

}  // namespace start_pose_test
}  // namespace nodmap::slam6d
