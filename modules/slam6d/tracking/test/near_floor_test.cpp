// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/near_floor.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "common/geometry/angle.hpp"
#include "modules/slam6d/test/mounted_scan.hpp"

namespace nodmap::slam6d {
namespace near_floor_test {

using geometry::deg_to_rad;
using geometry::rad_to_deg;
using geometry::SE3;

std::optional<MountError> seen_by_floor(const MountError& mount, const Room& room,
                                        const SE3& T_world_base) {
  std::mt19937 random(5);
  std::vector<scan::Scan> scans;
  for (std::int64_t i = 0; i < kScansOfSweep; ++i) {
    scans.push_back(mounted_scan(
        mount, i, room, [&](time::Timestamp) { return T_world_base; }, random));
  }
  const auto sweep = place(std::move(scans), [](time::Timestamp) { return SE3(SE3::Identity()); });
  return mount_error_by_floor(*sweep);
}

// Some 2000 points on the floor with 1 cm of noise, 1 m around on average, determine its tilts to
// 0.02 degrees; three times that. An error of 0.5 degrees is linear to 0.005 degrees.
constexpr double kToleranceDeg = 0.06;

TEST(NearFloor, ShowsPitchAndRoll) {
  for (const double pitch_deg : {-0.5, 0.0, 0.5}) {
    for (const double roll_deg : {-0.5, 0.0, 0.5}) {
      const auto seen = seen_by_floor({deg_to_rad(pitch_deg), deg_to_rad(roll_deg)}, Room::hall(),
                                      SE3::Identity());
      ASSERT_TRUE(seen);
      EXPECT_NEAR(rad_to_deg(seen->pitch_rad), pitch_deg, kToleranceDeg);
      EXPECT_NEAR(rad_to_deg(seen->roll_rad), roll_deg, kToleranceDeg);
    }
  }
}

TEST(NearFloor, OnASlopeTheWheelsAreOnItToo) {
  const SE3 T_world_base(Eigen::AngleAxisd(deg_to_rad(-8.0), Eigen::Vector3d::UnitY()));
  Room slope = Room::hall();
  slope.walls[0] = {T_world_base.linear().col(2), 0.0};
  const auto seen = seen_by_floor({}, slope, T_world_base);
  ASSERT_TRUE(seen);
  EXPECT_NEAR(rad_to_deg(seen->pitch_rad), 0.0, kToleranceDeg);
  EXPECT_NEAR(rad_to_deg(seen->roll_rad), 0.0, kToleranceDeg);
}

// A slope of 8 degrees begins at some distance ahead: what is beyond counts little, or the sweep
// says nothing. One sweep may be off by half a degree; the median of many must not be.
TEST(NearFloor, ASlopeAheadIsNoFloor) {
  const Eigen::Vector3d normal =
      Eigen::AngleAxisd(deg_to_rad(-8.0), Eigen::Vector3d::UnitY()) * Eigen::Vector3d::UnitZ();
  for (const double ahead_m : {0.5, 1.0, 1.5, 2.0, 3.0}) {
    Room room = Room::hall();
    room.walls.push_back({normal, normal.dot(Eigen::Vector3d(ahead_m, 0.0, 0.0))});
    if (const auto seen = seen_by_floor({}, room, SE3::Identity())) {
      EXPECT_NEAR(rad_to_deg(seen->pitch_rad), 0.0, 0.5) << ahead_m;
    }
  }
}

TEST(NearFloor, WithoutFloorNothingIsSeen) {
  const Room walls{{{{1, 0, 0}, 4.0}, {{0, 1, 0}, 3.0}, {{0, 1, 0}, -3.0}}};
  EXPECT_FALSE(seen_by_floor({}, walls, SE3::Identity()));
  const Room wall{{{{1, 0, 0}, 1.0}}};
  EXPECT_FALSE(seen_by_floor({}, wall, SE3::Identity()));
  EXPECT_FALSE(seen_by_floor({}, Room{}, SE3::Identity()));
}

// Behind and beside it sees as much floor as before; nothing ahead.
TEST(NearFloor, AWallCloseAheadLeavesNoFloorToDetermineThePitch) {
  Room room = Room::corridor();
  room.walls.push_back({{1, 0, 0}, 0.5});
  EXPECT_FALSE(seen_by_floor({}, room, SE3::Identity()));
}

}  // namespace near_floor_test
}  // namespace nodmap::slam6d
