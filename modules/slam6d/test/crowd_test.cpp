// SPDX-License-Identifier: BSD-3-Clause
// A robot that maps while people stand around it.
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/slam6d.hpp"
#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace crowd_test {

using geometry::SE3;

// The hall with five people in space that the keyframes have seen empty.
Room hall_with_people() {
  Room room = Room::hall();
  for (const auto& [x_m, y_m] : std::vector<std::pair<double, double>>{
           {1.5, 0.5}, {2.2, -0.5}, {3.4, 0.4}, {-0.5, 0.6}, {-1.5, -0.4}}) {
    room.boxes.emplace_back(Eigen::Vector3d(x_m - 0.2, y_m - 0.2, 0.0),
                            Eigen::Vector3d(x_m + 0.2, y_m + 0.2, 1.7));
  }
  return room;
}

// The robot starts at one end of the hall, which is the origin of map.
const SE3 kWorldStart = pose(-2.5, 0.0, 0.0);
SE3 in_map(const SE3& T_world_base) {
  return kWorldStart.inverse() * T_world_base;
}

PoseUpdate add_sweep(Slam6d& slam, SweepCloud cloud, const SE3& T_world_base) {
  cloud.T_odom_base = in_map(T_world_base);
  cloud.scans_used = 40;  // more than enough for a sweep
  return slam.add_cloud(std::move(cloud));
}

// Maps the hall from one end to the other, so that its space has been seen empty.
void map_hall(Slam6d& slam) {
  unsigned seed = 0;
  for (const SE3& T_world_base : along_hall()) {
    ASSERT_TRUE(
        add_sweep(slam, cloud_at(Room::hall(), T_world_base, seed++), T_world_base).is_tracked());
  }
  ASSERT_GE(slam.keyframes().size(), 4U);
}

// Among people more than 2 % of what the robot sees is in space that was seen empty. After one
// sweep was refused, this must not be held against all following ones.
TEST(Crowd, PeopleInFreeSpaceDoNotKeepTheRobotLost) {
  Slam6d slam({});
  map_hall(slam);
  const SE3 T_world_base = along_hall().back();
  PoseUpdate update =
      add_sweep(slam, cloud_at(box_about_robot(0.8), SE3::Identity(), 20), T_world_base);
  ASSERT_TRUE(update.registration);
  ASSERT_EQ(update.registration->state, PoseState::kLost);
  for (unsigned seed = 21; seed < 24; ++seed) {
    update = add_sweep(slam, cloud_at(hall_with_people(), T_world_base, seed), T_world_base);
    EXPECT_TRUE(update.is_tracked()) << seed;
    // Averaged over hundreds of points, 5 mm of noise leave less than 1 mm.
    EXPECT_LT((update.T_map_base.translation() - in_map(T_world_base).translation()).norm(), 0.005);
  }
  EXPECT_EQ(slam.metrics().sweeps_lost, 1U);
  EXPECT_FALSE(slam.localiser()) << "it takes long to make, and odometry is certain";
}

// A person stands so near that hardly any plane is seen. This does not contradict odometry.
TEST(Crowd, ASweepWithHardlyAnyPlaneIsNotLost) {
  Slam6d slam({});
  map_hall(slam);
  const PoseUpdate update =
      add_sweep(slam, cloud_at(box_about_robot(kBlindM), SE3::Identity(), 30), along_hall().back());
  EXPECT_FALSE(update.registration);
  EXPECT_EQ(slam.metrics().sweeps_lost, 0U);
}

}  // namespace crowd_test
}  // namespace nodmap::slam6d
