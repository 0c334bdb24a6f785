// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/mount_estimate.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "common/geometry/angle.hpp"
#include "modules/slam6d/test/mounted_scan.hpp"

namespace nodmap::slam6d {
namespace mount_estimate_test {

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

TEST(MountErrorByFloor, ShowsPitchAndRoll) {
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

TEST(MountErrorByFloor, OnASlopeTheWheelsAreOnItToo) {
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
TEST(MountErrorByFloor, ASlopeAheadIsNoFloor) {
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

TEST(MountErrorByFloor, WithoutFloorNothingIsSeen) {
  const Room walls{{{{1, 0, 0}, 4.0}, {{0, 1, 0}, 3.0}, {{0, 1, 0}, -3.0}}};
  EXPECT_FALSE(seen_by_floor({}, walls, SE3::Identity()));
  const Room wall{{{{1, 0, 0}, 1.0}}};
  EXPECT_FALSE(seen_by_floor({}, wall, SE3::Identity()));
  EXPECT_FALSE(seen_by_floor({}, Room{}, SE3::Identity()));
}

// Behind and beside it sees as much floor as before; nothing ahead.
TEST(MountErrorByFloor, AWallCloseAheadLeavesNoFloorToDetermineThePitch) {
  Room room = Room::corridor();
  room.walls.push_back({{1, 0, 0}, 0.5});
  EXPECT_FALSE(seen_by_floor({}, room, SE3::Identity()));
}

// What sweeps of a laser that looks too high show on uneven ground.
MountEstimate learned(double pitch_deg, double ground_deg, int num_sweeps, unsigned seed,
                      const MountParams& params = {}) {
  MountEstimate mount(params);
  std::mt19937 random(seed);
  std::normal_distribution<double> ground(0.0, deg_to_rad(ground_deg));
  for (int i = 0; i < num_sweeps; ++i) {
    mount.learn({deg_to_rad(pitch_deg) + ground(random), ground(random)});
  }
  return mount;
}

TEST(MountEstimate, HalfADegreeIsBelievedAfterTwelveSweeps) {
  // 4 * 1.25 * 0.3 / sqrt(n) degrees: 0.53 for 8 sweeps, 0.43 for 12
  EXPECT_TRUE(learned(0.45, 0.1, 8, 1).error().is_zero());
  // The median of 12 samples is exact to 1.25 * 0.1 / sqrt(12) = 0.036 degrees: three times that.
  EXPECT_NEAR(rad_to_deg(learned(0.5, 0.1, 12, 1).error().pitch_rad), 0.5, 0.11);
  EXPECT_EQ(learned(0.5, 0.1, 12, 1).error().roll_rad, 0.0);
  // 1.25 * 0.1 / sqrt(200) = 0.009 degrees
  EXPECT_NEAR(rad_to_deg(learned(0.5, 0.1, 200, 1).error().pitch_rad), 0.5, 0.027);
}

TEST(MountEstimate, SevenSweepsAreTooFew) {
  EXPECT_TRUE(learned(1.9, 0.0, 7, 1).error().is_zero());
  EXPECT_FALSE(learned(1.9, 0.0, 8, 1).error().is_zero());
}

// Four standard deviations, though looked at after each sweep.
TEST(MountEstimate, UnevenGroundIsNoErrorOfTheMount) {
  for (const double ground_deg : {0.1, 0.3, 0.5, 1.0}) {
    for (unsigned seed = 0; seed < 10; ++seed) {
      for (int num_sweeps = 1; num_sweeps <= 60; ++num_sweeps) {
        ASSERT_TRUE(learned(0.0, ground_deg, num_sweeps, seed).error().is_zero())
            << ground_deg << " degrees, seed " << seed;
      }
    }
  }
}

// A ramp right at the start: the first three sweeps see it ahead, the others do not.
TEST(MountEstimate, ARampAtTheStartIsNotBelieved) {
  MountEstimate mount({});
  for (int i = 0; i < 40; ++i) {
    mount.learn({i < 3 ? deg_to_rad(-1.5) : 0.0, 0.0});
    ASSERT_TRUE(mount.error().is_zero()) << i;
  }
}

TEST(MountEstimate, WhatIsTooLargeIsReportedOnly) {
  const MountEstimate mount = learned(2.5, 0.1, 20, 3);
  EXPECT_TRUE(mount.is_too_large());
  EXPECT_TRUE(mount.error().is_zero());
  EXPECT_NEAR(rad_to_deg(mount.believed().pitch_rad), 2.5, 0.1);
}

TEST(MountEstimate, IsNotCorrectedOnRequest) {
  const MountEstimate mount = learned(0.5, 0.1, 20, 4, {.use = false});
  EXPECT_TRUE(mount.error().is_zero());
  EXPECT_FALSE(mount.is_corrected_anew({}));
  EXPECT_NEAR(rad_to_deg(mount.believed().pitch_rad), 0.5, 0.1);
}

TEST(MountEstimate, IsCorrectedAnewOnlyIfItChangesMuch) {
  const MountEstimate mount = learned(0.5, 0.0, 20, 5);
  EXPECT_TRUE(mount.is_corrected_anew({}));
  EXPECT_TRUE(mount.is_corrected_anew({.pitch_rad = deg_to_rad(0.35)}));
  EXPECT_FALSE(mount.is_corrected_anew({.pitch_rad = deg_to_rad(0.45)}));
  EXPECT_TRUE(mount.is_corrected_anew({.pitch_rad = deg_to_rad(0.5), .roll_rad = 0.01}));
}

}  // namespace mount_estimate_test
}  // namespace nodmap::slam6d
