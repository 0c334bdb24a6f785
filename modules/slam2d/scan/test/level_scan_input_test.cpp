// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/level_scan_input.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "modules/slam2d/test/drawn_world.hpp"

namespace nodmap::slam2d {
namespace level_scan_input_test {

using geometry::SE2;

class LevelScans : public testing::Test {
 protected:
  void put_odometry(time::Duration since_epoch, const SE2& pose, bool has_restarted = false) {
    input_.add_odometry(time::Timestamp(since_epoch), geometry::to_se3(pose), has_restarted);
  }
  std::optional<LevelScan> scan_at(time::Duration since_epoch) {
    input_.add_scan(scanner_.scan(test::room(), {}, time::Timestamp(since_epoch)));
    return input_.next();
  }

  LevelScanInput input_{{}};
  test::Scanner scanner_;
};

void expect_near(const SE2& a, const SE2& b) {
  EXPECT_LT(distance_m(a, b), 1e-9);
  EXPECT_LT(rotation_rad(a, b), 1e-9);
}

// The pose after a gap includes the motion in the time of messages that were lost.
TEST_F(LevelScans, OnlyTimeWithoutPublishedOdometryIsAGap) {
  put_odometry(0ms, {});
  EXPECT_EQ(scan_at(0ms).value().odometry_gap_s, 0.0);
  put_odometry(3s, {});
  EXPECT_EQ(scan_at(3s).value().odometry_gap_s, 3.0);
  input_.add_odometry(time::Timestamp(6s), geometry::SE3::Identity(), false, 2s);
  EXPECT_EQ(scan_at(6s).value().odometry_gap_s, 1.0);
}

// The scan comes 0.2 s before odometry returns: where the robot was by then is not known.
TEST_F(LevelScans, NoScanIsPlacedWhereOdometryWasMissing) {
  put_odometry(0ms, {});
  EXPECT_TRUE(scan_at(0ms));
  EXPECT_FALSE(scan_at(3s - 200ms)) << "it waits";
  put_odometry(3s, {2.0, 0.0, 0.0});
  const auto scan = scan_at(3s);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->stamp, time::Timestamp(3s)) << "not the one that waited";
  EXPECT_EQ(input_.counts().without_odometry, 1);
}

// In 0.6 s without scans the robot drives on; then it hardly moves.
TEST_F(LevelScans, MotionWithoutScansIsUnseen) {
  for (int i = -10; i <= 0; ++i) {
    put_odometry(i * 20ms, {});
    EXPECT_EQ(scan_at(i * 20ms).value().unseen_s, 0.0);
  }
  const time::Duration scan_duration =
      scanner_.scan(test::room(), {}, {}).last_stamp().time_since_epoch();
  for (const time::Duration since_epoch : {200ms, 400ms, 600ms}) {
    put_odometry(since_epoch, {time::seconds(since_epoch), 0.0, 0.0});
  }
  const auto scan = scan_at(600ms);
  ASSERT_TRUE(scan);
  EXPECT_DOUBLE_EQ(scan->unseen_s, time::seconds(600ms - scan_duration));
  EXPECT_TRUE(scan->follows_unseen_motion());
  put_odometry(800ms, {0.6, 0.0, 0.4});
  put_odometry(1200ms, {0.6, 0.4, 0.4});
  EXPECT_EQ(scan_at(1200ms).value().unseen_s, 0.0);
}

// A recording with few scans lacks none.
TEST_F(LevelScans, MotionBetweenRareScansIsSeen) {
  for (int i = 0; i <= 20; ++i) {
    put_odometry(i * 1s, {1.0 * i, 0.0, 0.0});
    EXPECT_EQ(scan_at(i * 1s).value().unseen_s, 0.0);
  }
}

TEST_F(LevelScans, MotionByOdometryThatDidNotArriveIsUnseen) {
  put_odometry(0ms, {});
  EXPECT_TRUE(scan_at(0ms));
  input_.add_odometry(time::Timestamp(3s), geometry::SE3::Identity(), false, 2s);
  EXPECT_EQ(scan_at(3s).value().unseen_s, 2.0);
  EXPECT_EQ(scan_at(3010ms).value().unseen_s, 0.0);
}

// The first pose of the new frame is the same place as the last of the old one.
TEST_F(LevelScans, OdometryContinuesWhereItWasWhenItRestarts) {
  const SE2 step{0.3, 0.1, 0.5};
  SE2 expected{4.0, -7.0, 2.0};
  put_odometry(0ms, expected);
  for (const SE2& begin : {SE2{}, SE2{1.0, 2.0, -3.0}}) {  // restarts twice
    const std::int64_t i = begin.x == 0.0 ? 1 : 3;
    put_odometry(200ms * i, begin, true);
    put_odometry(200ms * (i + 1), begin * step);
    expected = expected * step;
    const auto scan = scan_at(200ms * (i + 1));
    ASSERT_TRUE(scan);
    expect_near(scan->T_odom_base, expected);
    expect_near(input_.T_odom_published() * (begin * step), expected);
  }
}

// The scan after a restart says so, and the next one does not.
TEST_F(LevelScans, OneLevelScanFollowsARestart) {
  put_odometry(0ms, {});
  EXPECT_FALSE(scan_at(0ms).value().odometry_has_restarted);
  put_odometry(200ms, {1.0, 0.0, 0.0}, true);
  EXPECT_TRUE(scan_at(200ms).value().odometry_has_restarted);
  EXPECT_FALSE(scan_at(210ms).value().odometry_has_restarted);
}

TEST_F(LevelScans, NoScanIsPlacedBetweenTwoOdometryFrames) {
  put_odometry(0ms, {3.0, 0.0, 0.0});
  put_odometry(400ms, {}, true);
  EXPECT_FALSE(scan_at(200ms));
  EXPECT_EQ(input_.counts().without_odometry, 1);
}

TEST_F(LevelScans, ARestartBeforeAnyOdometryBeginsAtThePublishedPose) {
  put_odometry(0ms, {3.0, 0.0, 1.0}, true);
  const auto scan = scan_at(0ms);
  ASSERT_TRUE(scan);
  EXPECT_EQ(scan->T_odom_base.x, 3.0);
  EXPECT_EQ(scan->T_odom_base.yaw, 1.0);
}

TEST_F(LevelScans, TheLongestGapInOdometrySinceTheLastLevelScanIsKnown) {
  put_odometry(0ms, {});
  put_odometry(700ms, {});
  put_odometry(800ms, {});
  EXPECT_EQ(scan_at(800ms).value().odometry_gap_s, 0.7);
  EXPECT_EQ(scan_at(810ms).value().odometry_gap_s, 0.0);
}

// A level laser of 75 scans a second on a base that sends its pose 5 times a second.
TEST_F(LevelScans, LevelScansWaitForSlowOdometry) {
  constexpr double kSpeedMps = 1.0;
  constexpr time::Duration kScanPeriod = 13ms;
  constexpr time::Duration kOdometryPeriod = 200ms;
  std::vector<time::Timestamp> placed;
  const auto place_waiting = [&] {
    while (const auto scan = input_.next()) {
      placed.push_back(scan->stamp);
      const double time_s = time::seconds(scan->stamp.time_since_epoch());
      expect_near(scan->T_odom_base, {kSpeedMps * time_s, 0.0, 0.0});
    }
  };
  time::Duration odometry = -kOdometryPeriod;
  for (time::Duration now{}; now < 2s; now += kScanPeriod) {
    for (; odometry <= now; odometry += kOdometryPeriod) {
      put_odometry(odometry, {kSpeedMps * time::seconds(odometry), 0.0, 0.0});
    }
    input_.add_scan(scanner_.scan(test::room(), {}, time::Timestamp(now)));
    place_waiting();
  }
  EXPECT_EQ(input_.counts().without_odometry, 0);
  EXPECT_FALSE(input_.lacks_odometry());
  EXPECT_TRUE(std::ranges::is_sorted(placed));
  EXPECT_EQ(placed.back(), time::Timestamp(1846ms));  // 1.8 s of odometry and 50 ms, cut to a scan
  EXPECT_EQ(placed.size(), 143U);
}

TEST_F(LevelScans, AScanForWhichNoOdometryComesIsCountedAfterHalfASecond) {
  put_odometry(0ms, {});
  EXPECT_FALSE(scan_at(100ms));
  EXPECT_FALSE(scan_at(590ms));
  EXPECT_EQ(input_.counts().without_odometry, 0);
  EXPECT_FALSE(scan_at(620ms));
  EXPECT_EQ(input_.counts().without_odometry, 1);
  EXPECT_TRUE(input_.lacks_odometry());
  input_.stop_waiting();
  EXPECT_EQ(input_.counts().without_odometry, 3);
  put_odometry(700ms, {});
  EXPECT_TRUE(scan_at(700ms));
  EXPECT_FALSE(input_.lacks_odometry());
}

TEST_F(LevelScans, OdometryThatIsNotFiniteIsIgnored) {
  put_odometry(0ms, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0});
  EXPECT_FALSE(scan_at(0ms));
}

TEST_F(LevelScans, OdometryThatIsNotFiniteIsIgnoredWhenItRestartsAsWell) {
  put_odometry(0ms, {4.0, -7.0, 2.0});
  put_odometry(200ms, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, true);
  put_odometry(400ms, {}, true);
  const auto scan = scan_at(400ms);
  ASSERT_TRUE(scan);
  expect_near(scan->T_odom_base, {4.0, -7.0, 2.0});
}

// A laser that nods by a degree from scan to scan, in 13 ms each, over a robot that does not move.
class ANod : public LevelScans {
 protected:
  ANod() {
    for (int i = 0; i < 100; ++i) {
      put_odometry(kScanPeriod * i, {});
    }
  }
  // Adds a scan with this mean pitch; returns the stamp of the level scan that is ready then.
  std::optional<time::Timestamp> add(double pitch_deg, double nod_deg = -1.0) {
    scan::Scan scan = scanner_.scan(test::room(), {}, now_);
    scan.pitch_first_rad = geometry::deg_to_rad(pitch_deg - nod_deg / 2);
    scan.pitch_last_rad = geometry::deg_to_rad(pitch_deg + nod_deg / 2);
    now_ += kScanPeriod;
    input_.add_scan(scan);
    return next();
  }
  std::optional<time::Timestamp> next() {
    const auto level_scan = input_.next();
    EXPECT_TRUE(!level_scan || level_scan->points_base.size() == 181U);
    return level_scan ? std::optional(level_scan->stamp) : std::nullopt;
  }
  // Three scans of a sweep that goes down, of which the last is level.
  time::Timestamp begin_sweep() {
    const time::Timestamp level = now_ + 2 * kScanPeriod;
    for (const double pitch_deg : {1.8, 0.8, -0.2}) {
      EXPECT_FALSE(add(pitch_deg));
    }
    return level;
  }

  static constexpr time::Duration kScanPeriod = 13ms;
  time::Timestamp now_{};
};

TEST_F(ANod, InASweepThatGoesDownALevelScanWaitsForTheTwoScansBelowIt) {
  const time::Timestamp level = begin_sweep();
  EXPECT_FALSE(add(-1.2));
  EXPECT_EQ(add(-2.2), level);
  EXPECT_FALSE(add(-3.2));
}

TEST_F(ANod, InASweepThatGoesUpALevelScanDoesNotWait) {
  EXPECT_FALSE(add(-2.2, 1.0));
  EXPECT_FALSE(add(-1.2, 1.0));
  EXPECT_FALSE(add(-0.2, 1.0));
  EXPECT_EQ(add(0.8, 1.0), time::Timestamp(26ms));
}

TEST_F(ANod, WithTheSlopesLeftInALevelScanDoesNotWait) {
  input_ = LevelScanInput({.leave_out_slopes = false});
  put_odometry(0ms, {});
  EXPECT_FALSE(add(1.8));
  EXPECT_FALSE(add(0.8));
  EXPECT_EQ(add(-0.2), time::Timestamp(26ms));
}

TEST_F(ANod, ALevelScanDoesNotWaitForScansThatAreLost) {
  const time::Timestamp level = begin_sweep();
  now_ += 4 * kScanPeriod;
  EXPECT_EQ(add(-6.2), level);
}

TEST_F(ANod, AtTheEndALevelScanIsUsedWithoutTheScansBelowIt) {
  const time::Timestamp level = begin_sweep();
  input_.end_scans();
  EXPECT_EQ(next(), level);
  EXPECT_FALSE(next());
  EXPECT_EQ(input_.counts().without_odometry, 0);
}

// The servo is held, or goes back, where the scans below the level one would come.
TEST_F(ANod, ALevelScanDoesNotWaitForAServoThatStops) {
  const time::Timestamp level = begin_sweep();
  EXPECT_FALSE(add(-0.7, 0.0));
  EXPECT_EQ(add(-0.7, 0.0), level);
}

TEST_F(ANod, ALevelScanDoesNotWaitForAServoThatGoesBack) {
  const time::Timestamp level = begin_sweep();
  EXPECT_FALSE(add(-0.7));
  EXPECT_EQ(add(-0.1, 1.0), level);
}

}  // namespace level_scan_input_test
}  // namespace nodmap::slam2d
