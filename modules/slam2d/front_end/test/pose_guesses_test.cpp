// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/front_end/pose_guesses.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nodmap::slam2d {
namespace pose_guesses_test {

using geometry::SE2;

constexpr time::Duration kPeriod = 200ms;
const SE2 kStep{0.2, 0.0, 0.1};  // 1 m/s on a circle of 2 m

bool are_near(const SE2& a, const SE2& b) {
  return std::hypot(a.x - b.x, a.y - b.y) < 1e-9 &&
         std::abs(geometry::angle_difference(a.yaw, b.yaw)) < 1e-9;
}

// A robot that drives steadily. Odometry and map agree until odometry hangs.
class Drive {
 public:
  Drive() {
    pose_guesses_.count_odometry_from({}, {});
    pose_guesses_.add_scan(time::Timestamp{}, {});
    go_on(kStep);
  }
  // The guesses for the next scan, if odometry has counted `T_odom_step` since the last one.
  std::vector<SE2> guesses(const SE2& T_odom_step) {
    scan_.stamp += kPeriod;
    scan_.T_odom_base = T_odom_last_ * T_odom_step;
    return pose_guesses_.guesses(scan_, T_map_odom_, T_odom_last_);
  }
  // Adds the next scan. Whatever odometry counts, matching finds that the robot has continued its
  // motion.
  void go_on(const SE2& T_odom_step) {
    (void)guesses(T_odom_step);
    truth_ = truth_ * kStep;
    T_odom_last_ = scan_.T_odom_base;
    T_map_odom_ = truth_ * T_odom_last_.inverse();
    pose_guesses_.add_scan(scan_.stamp, kStep);
  }
  [[nodiscard]] SE2 next_truth() const { return truth_ * kStep; }
  PoseGuesses& pose_guesses() { return pose_guesses_; }
  void wait(time::Duration duration) { scan_.stamp += duration; }
  void move_unseen(double duration_s) { scan_.unseen_s = duration_s; }

 private:
  PoseGuesses pose_guesses_{PeopleParams{}};
  LevelScan scan_;
  SE2 truth_;
  SE2 T_map_odom_;
  SE2 T_odom_last_;
};

TEST(PoseGuesses, OdometryThatAgreesWithTheMotionIsTheOnlyGuess) {
  Drive drive;
  const auto guesses = drive.guesses(kStep * SE2{0.05, 0.02, -0.05});
  ASSERT_EQ(guesses.size(), 1U);
  EXPECT_FALSE(are_near(guesses.front(), drive.next_truth()));  // by odometry, not by the motion
}

TEST(PoseGuesses, IfOdometryReportsNoMotionASecondGuessContinuesTheLastMotion) {
  Drive drive;
  const auto guesses = drive.guesses({});
  ASSERT_EQ(guesses.size(), 2U);
  EXPECT_TRUE(are_near(guesses[1], drive.next_truth()));
}

// Odometry reports a motion of which no scan has been received: the last motion does not tell it.
TEST(PoseGuesses, UnseenMotionHasNoOtherGuessThanOdometry) {
  Drive drive;
  drive.move_unseen(1.0);
  EXPECT_EQ(drive.guesses({5.0, 1.0, 2.0}).size(), 1U);
  drive.move_unseen(0.5);
  EXPECT_EQ(drive.guesses({5.0, 1.0, 2.0}).size(), 2U);
}

TEST(PoseGuesses, MotionThatOdometryReportsLateIsNotCountedTwice) {
  Drive drive;
  drive.go_on({});
  drive.go_on({});
  const auto guesses = drive.guesses(kStep * kStep * kStep);
  ASSERT_GE(guesses.size(), 2U);
  EXPECT_TRUE(are_near(guesses.front(), drive.next_truth())) << "since the last keyframe";
}

TEST(PoseGuesses, StampsInBurstsAreNotUsedToEstimateTheSpeed) {
  Drive drive;
  drive.wait(-kPeriod * 9 / 10);  // the next scan comes 20 ms after the last
  EXPECT_EQ(drive.guesses({}).size(), 1U);
}

// Two scans at a time have nearly the same stamp, although the laser measures at an even rate. The
// mean motion from scan to scan is therefore known.
TEST(PoseGuesses, InBurstsAGuessRepeatsTheMeanMotionPerScan) {
  Drive drive;
  for (int i = 0; i < 8; ++i) {
    drive.wait(i % 2 == 0 ? -kPeriod * 9 / 10 : kPeriod * 9 / 10);
    drive.go_on(kStep);
  }
  drive.wait(-kPeriod * 9 / 10);
  Drive slipping = drive;
  EXPECT_EQ(drive.guesses(kStep).size(), 1U);  // odometry agrees
  const auto guesses = slipping.guesses(kStep * SE2{0.5, 0.0, 0.0});
  EXPECT_TRUE(std::any_of(guesses.begin(), guesses.end(), [&](const SE2& guess) {
    return are_near(guess, slipping.next_truth());
  }));
}

// Half a second after the last scan, or after a scan that fitted nowhere, the robot's motion is
// unknown.
TEST(PoseGuesses, AnOldOrForgottenMotionGivesNoGuess) {
  Drive drive;
  drive.wait(500ms);
  EXPECT_EQ(drive.guesses({}).size(), 1U);
  Drive lost;
  lost.pose_guesses().forget_motion();
  EXPECT_EQ(lost.guesses({}).size(), 1U);
  Drive back;
  back.wait(-1s);  // stamps step back
  EXPECT_EQ(back.guesses({}).size(), 1U);
}

TEST(PoseGuesses, OnlyScansInQuickSuccessionAreFast) {
  for (const auto& [period, is_fast] :
       {std::pair{13ms, true}, {50ms, true}, {60ms, false}, {200ms, false}, {1ms, false}}) {
    PoseGuesses pose_guesses{PeopleParams{}};
    EXPECT_FALSE(pose_guesses.is_fast(time::Timestamp{}));
    pose_guesses.add_scan(time::Timestamp{}, {});
    EXPECT_FALSE(pose_guesses.is_fast(time::Timestamp(period)));  // how it moves is not known yet
    pose_guesses.add_scan(time::Timestamp(period), kStep);
    EXPECT_EQ(pose_guesses.is_fast(time::Timestamp(2 * period)), is_fast);
    EXPECT_FALSE(pose_guesses.is_fast(time::Timestamp(period + 1s)));
    pose_guesses.forget_motion();
    EXPECT_FALSE(pose_guesses.is_fast(time::Timestamp(2 * period)));
  }
}

TEST(PoseGuesses, TheLongestScanPeriodThatIsFastIsAParameter) {
  for (const auto& [max_scan_period_s, is_fast] :
       {std::pair{0.0, false}, {0.05, false}, {0.25, true}}) {
    PoseGuesses pose_guesses{PeopleParams{.max_scan_period_s = max_scan_period_s}};
    pose_guesses.add_scan(time::Timestamp{}, {});
    pose_guesses.add_scan(time::Timestamp(kPeriod), kStep);
    EXPECT_EQ(pose_guesses.is_fast(time::Timestamp(2 * kPeriod)), is_fast) << max_scan_period_s;
  }
}

// A match may differ from odometry since the last scan by 3 cm and 1.7 degrees, plus 1 m and 60
// degrees per second. It may differ from odometry since the last keyframe by 3 cm and 1.7 degrees,
// plus half of the motion that odometry has counted.
TEST(PoseGuesses, TheAllowedSlipGrowsWithTheMotionByOdometry) {
  PoseGuesses pose_guesses{PeopleParams{}};
  pose_guesses.count_odometry_from({}, {});
  pose_guesses.add_scan(time::Timestamp{}, {});
  LevelScan scan;
  scan.stamp = time::Timestamp(10ms);
  EXPECT_FALSE(pose_guesses.is_beyond_slip(scan, {}, {0.029, 0.0, 0.029}));
  EXPECT_TRUE(pose_guesses.is_beyond_slip(scan, {}, {0.041, 0.0, 0.0}));
  EXPECT_TRUE(pose_guesses.is_beyond_slip(scan, {}, {0.0, 0.0, 0.041}));
  EXPECT_TRUE(pose_guesses.is_beyond_slip(scan, {0.1, 0.0, 0.0}, {0.1, 0.0, 0.0}));
  scan.T_odom_base.x = 0.2;
  EXPECT_FALSE(pose_guesses.is_beyond_slip(scan, {0.3, 0.0, 0.08}, {0.32, 0.0, 0.1}));
  EXPECT_TRUE(pose_guesses.is_beyond_slip(scan, {0.3, 0.0, 0.08}, {0.335, 0.0, 0.1}));
  pose_guesses.count_odometry_from({0.1, 0.0, 0.0}, scan.T_odom_base);  // it was believed
  EXPECT_FALSE(pose_guesses.is_beyond_slip(scan, {0.3, 0.0, 0.0}, {0.3, 0.0, 0.0}));
}

}  // namespace pose_guesses_test
}  // namespace nodmap::slam2d
