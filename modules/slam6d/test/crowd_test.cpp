// SPDX-License-Identifier: BSD-3-Clause People around a robot that maps.
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/slam6d.hpp"
#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace crowd_test {

using geometry::SE3;

// Five people who stand where the keyframes saw nobody.
Room hall_with_people() {
  Room room = Room::hall();
  for (const auto& [x_m, y_m] : std::vector<std::pair<double, double>>{
           {1.5, 0.5}, {2.2, -0.5}, {3.4, 0.4}, {-0.5, 0.6}, {-1.5, -0.4}}) {
    room.boxes.emplace_back(Eigen::Vector3d(x_m - 0.2, y_m - 0.2, 0.0),
                            Eigen::Vector3d(x_m + 0.2, y_m + 0.2, 1.7));
  }
  return room;
}

// What a robot sees while somebody blocks its view: surfaces that fit nowhere.
Room box_about_robot(double half_width_m) {
  return {{{{1, 0, 0}, half_width_m},
           {{-1, 0, 0}, half_width_m},
           {{0, 1, 0}, half_width_m},
           {{0, -1, 0}, half_width_m}}};
}

// The robot's start at one end of the hall, and its pose in map.
const SE3 kWorldStart = pose(-2.5, 0.0, 0.0);
SE3 in_map(const SE3& T_world_base) {
  return kWorldStart.inverse() * T_world_base;
}

PoseUpdate add_sweep(Slam6d& slam, SweepCloud cloud, const SE3& T_world_base) {
  cloud.T_odom_base = in_map(T_world_base);
  cloud.scans_used = 40;  // as many as rows
  return slam.add_cloud(std::move(cloud));
}

// From one end of the hall to the other, so that its space has been seen empty.
void map_hall(Slam6d& slam) {
  unsigned seed = 0;
  for (const SE3& T_world_base : along_hall()) {
    ASSERT_TRUE(
        add_sweep(slam, cloud_at(Room::hall(), T_world_base, seed++), T_world_base).is_tracked());
  }
  ASSERT_GE(slam.keyframes().size(), 4U);
}

// In a crowd more than 2 % of what a robot sees is in space that was seen empty. One refused sweep
// must not make all the following ones suspect.
TEST(Crowd, PeopleDoNotKeepARobotLost) {
  Slam6d slam({});
  map_hall(slam);
  const SE3 T_world_base = along_hall().back();
  PoseUpdate update =
      add_sweep(slam, cloud_at(box_about_robot(0.8), SE3::Identity(), 20), T_world_base);
  ASSERT_TRUE(update.registration);
  ASSERT_EQ(update.registration->status, RegistrationStatus::kLost);
  for (unsigned seed = 21; seed < 24; ++seed) {
    update = add_sweep(slam, cloud_at(hall_with_people(), T_world_base, seed), T_world_base);
    EXPECT_TRUE(update.is_tracked()) << seed;
    // Averaged over hundreds of points, 5 mm of noise leave less than 1 mm.
    EXPECT_LT((update.T_map_base.translation() - in_map(T_world_base).translation()).norm(), 0.005);
  }
  EXPECT_EQ(slam.metrics().sweeps_lost, 1U);
}

// Somebody stands so near that hardly any plane is seen. This does not contradict odometry.
TEST(Crowd, ASweepThatSeesNextToNothingIsNotLost) {
  Slam6d slam({});
  map_hall(slam);
  const PoseUpdate update =
      add_sweep(slam, cloud_at(box_about_robot(0.12), SE3::Identity(), 30), along_hall().back());
  EXPECT_FALSE(update.registration);
  EXPECT_EQ(slam.metrics().sweeps_lost, 0U);
}

}  // namespace crowd_test
}  // namespace nodmap::slam6d
