// SPDX-License-Identifier: BSD-3-Clause
// A robot that is kicked or carried away while it maps searches for its pose in its own map.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

#include "modules/slam6d/slam6d.hpp"
#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace own_map_search_test {

using geometry::SE3;

// A robot that has mapped Room::hall() from x = -2.5 m to x = 3.5 m.
class RobotInAHall : public testing::Test {
 protected:
  RobotInAHall() {
    for (const SE3& T_map_base : along_hall()) {
      see(Room::hall(), T_map_base, T_map_base);
    }
  }

  // Adds a sweep that is taken at T_map_base of `room`, `gap` later than the usual second.
  PoseUpdate see(const Room& room, const SE3& T_map_base, const SE3& T_odom_base,
                 time::Duration gap = {}) {
    SweepCloud cloud = cloud_at(room, T_map_base, ++seed_);
    stamp_ += 1s + gap;
    cloud.stamp = stamp_;
    cloud.T_odom_base = T_odom_base;
    cloud.scans_used = 80;
    cloud.follows_interruption = gap > 0s;
    return slam_.add_cloud(std::move(cloud));
  }

  // The map frame is the frame of the hall, because odometry was right when mapping began. The
  // tolerance is that of registration: 5 mm of range noise.
  static void expect_right(const PoseUpdate& update, const SE3& T_hall_base) {
    const SE3 error = T_hall_base.inverse() * update.T_map_base;
    EXPECT_LT(error.translation().norm(), 0.01);
    EXPECT_LT(geometry::rotation_angle(error), geometry::deg_to_rad(0.2));
  }

  Slam6d slam_{{}};
  unsigned seed_ = 0;
  time::Timestamp stamp_{};
};

// The robot is carried 5 m away and rotated by 100 degrees. The long walls fit nearly anywhere, but
// the end walls contradict.
TEST_F(RobotInAHall, IsFoundAfterItWasCarriedAway) {
  const SE3 T_hall_carried = pose(-1.8, 0.1, 100.0);
  const SE3 T_odom_hall = along_hall().back() * T_hall_carried.inverse();
  const std::size_t num_voxels = slam_.metrics().map_voxels;
  for (int i = 0; i < 4; ++i) {
    const PoseUpdate lost = see(Room::hall(), T_hall_carried, T_odom_hall * T_hall_carried);
    EXPECT_EQ(lost.registration->state, PoseState::kLost);
    EXPECT_TRUE(slam_.may_search());
  }
  // The fifth sweep starts a search. The place is confirmed only when the robot is 3 m farther on.
  for (const double x_m : {-1.8, -1.0, 0.0, 1.0}) {
    const SE3 T_hall_base = pose(x_m, 0.1, 100.0);
    const PoseUpdate found = see(Room::hall(), T_hall_base, T_odom_hall * T_hall_base);
    EXPECT_EQ(found.registration->state, PoseState::kDegraded) << x_m;
    expect_right(found, T_hall_base);
    EXPECT_EQ(slam_.metrics().map_voxels, num_voxels);
  }
  const SE3 T_hall_base = pose(1.5, 0.1, 100.0);
  const PoseUpdate confirmed = see(Room::hall(), T_hall_base, T_odom_hall * T_hall_base);
  EXPECT_EQ(confirmed.registration->state, PoseState::kTracking);
  EXPECT_EQ(confirmed.keyframe, KeyframeReason::kInterruption);
  expect_right(confirmed, T_hall_base);
  EXPECT_FALSE(slam_.may_search());
  // When it is carried away and lost again, the first search still counts.
  ASSERT_EQ(slam_.localiser()->metrics().found, 1);
  for (int i = 0; i < 2; ++i) {
    const PoseUpdate lost = see(Room::hall(), pose(-2.5, 0.1, 0.0), T_odom_hall * T_hall_base);
    EXPECT_EQ(lost.registration->state, PoseState::kLost);
  }
  EXPECT_EQ(slam_.localiser()->metrics().found, 1);
}

// The robot is carried to another hall, which differs only by its cabinets from the one that was
// mapped.
TEST_F(RobotInAHall, IsNotFoundInASimilarHall) {
  const std::size_t num_voxels = slam_.metrics().map_voxels;
  for (int i = 0; i < 12; ++i) {
    const PoseUpdate update = see(look_alike_hall(), pose(-1.8 + 0.3 * i, 0.1, 100.0),
                                  along_hall().back() * pose(0.0, -0.3 * i, 0.0));
    ASSERT_TRUE(update.registration);
    EXPECT_EQ(update.registration->state, PoseState::kLost) << i;
    EXPECT_EQ(slam_.metrics().map_voxels, num_voxels) << i;
  }
}

// The robot is carried to another hall, which looks like a place 5 m away until its cabinets come
// into view. The poses that were registered at that place are taken back, also when the robot has
// been brought back to its true place.
TEST_F(RobotInAHall, FollowsOdometryWhereAPlaceProvedWrong) {
  const SE3 T_odom_base = along_hall().back();
  const SE3 T_hall_similar = pose(-1.8, 0.1, 100.0);
  const auto expect_near_odometry = [this] {
    const auto trajectory = slam_.trajectory();
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
      EXPECT_LT((trajectory[i].translation() - slam_.sweeps()[i].T_first_base.translation()).norm(),
                0.1)
          << i;
    }
  };
  const std::size_t lost_at_first = 4;
  for (std::size_t i = 0; i < lost_at_first + 3; ++i) {
    const PoseUpdate update = see(Room::hall(), T_hall_similar, T_odom_base);
    EXPECT_EQ(update.is_tracked(), i >= lost_at_first) << i;
  }
  PoseUpdate update;
  do {
    update = see(look_alike_hall(), T_hall_similar, T_odom_base);
    ASSERT_LT(slam_.sweeps().size(), 20U);
  } while (update.is_tracked());
  EXPECT_EQ(slam_.localiser()->metrics().times_lost, 1);
  EXPECT_EQ(slam_.metrics().sweeps_degraded, 0U);
  expect_near_odometry();
  EXPECT_TRUE(see(Room::hall(), T_odom_base, T_odom_base).is_tracked());
  expect_near_odometry();
}

// The robot is carried back to the end of a corridor and rotated, is found there, and drives on to
// where the map ends and beyond. Elsewhere only odometry, which is exact here, says how far it is
// along the corridor, so these poses are DEGRADED.
TEST(OwnMapSearch, APlaceIsConfirmedInABareCorridor) {
  Room room = Room::corridor();
  room.walls.push_back({Eigen::Vector3d(1.0, 0.3, 0.0).normalized(), -1.5});
  room.boxes = {{Eigen::Vector3d(-0.8, 0.5, 0.0), Eigen::Vector3d(0.4, 1.1, 2.0)}};
  Slam6d slam({});
  unsigned seed = 0;
  time::Timestamp stamp{};
  const auto see = [&](const SE3& T_map_base, const SE3& T_odom_map) {
    SweepCloud cloud = cloud_at(room, T_map_base, ++seed);
    constexpr float kRangeM = 2.5F;
    std::erase_if(cloud.points, [](const Eigen::Vector3f& p) { return p.norm() > kRangeM; });
    cloud.lines.back().end = cloud.points.size();
    stamp += 1s;
    cloud.stamp = stamp;
    cloud.T_odom_base = T_odom_map * T_map_base;
    cloud.scans_used = 80;
    return slam.add_cloud(std::move(cloud));
  };
  constexpr double kMapEndM = 10.0;
  for (double x_m = 0.0; x_m <= kMapEndM; x_m += 0.5) {
    (void)see(pose(x_m, 0.0, 0.0), SE3::Identity());
  }
  const SE3 T_odom_map = pose(kMapEndM, 0.0, 0.0) * pose(0.4, 0.0, 100.0).inverse();
  for (int i = 0; i < 4; ++i) {
    EXPECT_FALSE(see(pose(0.4, 0.0, 100.0), T_odom_map).is_tracked());
  }
  // The tolerance is 1 cm, and a hundredth of the way, by which walls may pull along a corridor.
  for (double x_m = 0.4; x_m <= 25.0; x_m += 0.5) {
    const PoseUpdate update = see(pose(x_m, 0.0, 100.0), T_odom_map);
    ASSERT_TRUE(update.is_tracked()) << x_m;
    EXPECT_NEAR(update.T_map_base.translation().x(), x_m, 0.01 + 0.01 * x_m);
  }
  EXPECT_EQ(slam.localiser()->metrics().found, 1);
  EXPECT_EQ(slam.localiser()->metrics().times_lost, 0);
}

// The robot turns nearly once round without seeing anything. Odometry counts a tenth
// too much: that it counted 350 degrees, not 10, says how far off it may be.
TEST_F(RobotInAHall, ATurnWhileItIsBlindCountsAsAWhole) {
  constexpr int kSteps = 14;
  constexpr double kTurnDeg = 315.0;
  const auto turned = [](double deg) { return along_hall().back() * pose(0.0, 0.0, deg); };
  for (int i = 1; i <= kSteps; ++i) {
    const double part = static_cast<double>(i) / kSteps;
    const PoseUpdate blind = see(Room{}, turned(part * kTurnDeg), turned(part * kTurnDeg / 0.9));
    EXPECT_FALSE(blind.registration) << i;
  }
  const PoseUpdate update = see(Room::hall(), turned(kTurnDeg), turned(kTurnDeg / 0.9));
  EXPECT_TRUE(update.is_tracked());
  expect_right(update, turned(kTurnDeg));
}

// The robot is moved by 0.3 m and rotated by 30 degrees during a gap of 2 s. From then on odometry
// counts 10 % too much rotation.
TEST_F(RobotInAHall, IsNeverTrackedAtAWrongPoseAfterAKick) {
  SE3 T_odom_base = along_hall().back();
  SE3 T_hall_base = along_hall().back() * pose(0.3, 0.1, 30.0);
  PoseUpdate last;
  for (int i = 0; i < 8; ++i) {
    last = see(Room::hall(), T_hall_base, T_odom_base, i == 0 ? 2s : 0s);
    if (last.is_tracked()) {
      expect_right(last, T_hall_base);
    }
    T_hall_base = T_hall_base * pose(0.0, 0.0, 20.0);
    T_odom_base = T_odom_base * pose(0.0, 0.0, 22.0);
  }
  EXPECT_EQ(last.registration->state, PoseState::kTracking);
}

}  // namespace own_map_search_test
}  // namespace nodmap::slam6d
