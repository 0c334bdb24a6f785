// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "modules/slam2d/test/drawn_world.hpp"
#include "modules/slam2d/test/track.hpp"

namespace nodmap::slam2d {
namespace doubt_test {

using geometry::SE2;
using test::kPeriod;
using test::Scanner;
using test::track;

// Scans come once a second, with gaps in odometry between them, as in logs whose stamps come in
// bursts. The robot has not moved in the gaps.
TEST(Slam2d, AScanThatFitsAfterAGapStartsNoSearch) {
  test::Slam slam;
  Scanner scanner;
  for (int i = 0; i < 10; ++i) {
    const auto update = track(slam, scanner.scan(test::room(), {}, time::Timestamp(1s * i)), {});
    ASSERT_TRUE(update);
    EXPECT_EQ(update->state, PoseState::kTracking);
  }
  EXPECT_EQ(slam.metrics().searches.made, 0);
}

// Three standard deviations of odometry, but the search ends before: then no place is sure.
TEST(Doubt, AfterLostMessagesItReachesAsFarAsOdometryMayBeWrong) {
  Doubt doubt{DoubtParams{.search_distance_m = 4.0}};
  doubt.begin_by_odometry(1.0);
  EXPECT_EQ(doubt.search_distance_m(), 3.0);
  EXPECT_FALSE(doubt.exceeds_search());
  doubt.begin_by_odometry(2.0);
  EXPECT_EQ(doubt.search_distance_m(), 4.0);
  EXPECT_TRUE(doubt.exceeds_search());
  EXPECT_EQ(doubt.sigma_m(), 2.0);
  doubt.begin(1.0);
  EXPECT_EQ(doubt.reach_m(), 6.0) << "a gap does not lessen it";
}

// For a second nothing is recorded, and odometry does not count the robot's motion in this time.
TEST(Slam2d, MotionDuringAPauseInOdometryIsFoundFromTheScans) {
  test::Slam slam;
  Scanner scanner;
  SE2 truth{-1.5, -0.5, 0.0};
  const SE2 start = truth;
  SE2 odom;
  time::Timestamp stamp{};
  const SE2 step{0.1, 0.0, 0.08};
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(track(slam, scanner.scan(test::room(), truth, stamp), odom));
    truth = truth * step;
    odom = odom * step;
    stamp += kPeriod;
  }
  truth = truth * SE2{-0.9, -2.6, -0.6};  // beyond the start poses that are tried near odometry
  stamp += 1s;
  double worst_m = 0.0;
  for (int i = 0; i < 20; ++i) {
    const auto update = track(slam, scanner.scan(test::room(), truth, stamp), odom);
    ASSERT_TRUE(update);
    if (update->state != PoseState::kLost) {
      worst_m = std::max(worst_m, distance_m(update->T_map_base, start.inverse() * truth));
    }
    EXPECT_TRUE(i < 5 || update->state != PoseState::kLost) << i;
    const SE2 back{step.x, 0.0, -step.yaw};
    truth = truth * back;
    odom = odom * back;
    stamp += kPeriod;
  }
  EXPECT_LT(worst_m, 0.0043);  // measured 3.5 mm, from scan noise of 1 cm
}

// As above, but the scans follow one another within milliseconds, and the robot is stationary
// after the pause. The last keyframe is from before it: odometry since then does not tell where the
// robot is.
TEST(Slam2d, APlaceFoundAfterAPauseInOdometryIsKept) {
  for (const SE2& unseen : {SE2{0.2, 0.0, 0.0}, SE2{-0.9, -2.6, -0.6}}) {
    test::Slam slam;
    Scanner scanner;
    const SE2 start{-1.5, -0.5, 0.0};
    SE2 truth = start;
    SE2 odom;
    time::Timestamp stamp{};
    const SE2 step{0.1, 0.0, 0.08};
    auto update = track(slam, scanner.scan(test::room(), truth, stamp), odom);
    for (int i = 0; i < 20 || !update->is_keyframe; ++i) {
      truth = truth * step;
      odom = odom * step;
      stamp += kPeriod;
      update = track(slam, scanner.scan(test::room(), truth, stamp), odom);
      ASSERT_TRUE(update);
    }
    truth = truth * unseen;
    stamp += 1s;
    for (int i = 0; i < 10; ++i) {
      update = track(slam, scanner.scan(test::room(), truth, stamp), odom);
      ASSERT_TRUE(update);
      EXPECT_FALSE(update->is_keyframe);
      EXPECT_EQ(update->state, PoseState::kTracking) << unseen.x << " m, scan " << i;
      // Two standard deviations of the scan noise.
      EXPECT_LT(distance_m(update->T_map_base, start.inverse() * truth), 0.02) << i;
      stamp += 13ms;
    }
  }
}

struct Found {
  PoseUpdate update;
  double error_m = 0.0;
};

// Returns the pose of the first scan after a pause in which the robot moved by 2.8 m, to a place
// where a new board stands in front of it. Many of the scan's points are not in the map.
Found after_pause_before_a_board(const Slam2dParams& params) {
  test::Slam slam{params};
  Scanner scanner;
  const SE2 step{0.1, 0.0, 0.08};
  const SE2 start{-1.5, -0.5, 0.0};
  SE2 truth = start;
  SE2 odom;
  time::Timestamp stamp{};
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(track(slam, scanner.scan(test::room(), truth, stamp), odom));
    truth = truth * step;
    odom = odom * step;
    stamp += kPeriod;
  }
  truth = truth * SE2{-0.9, -2.6, -0.6};
  test::FloorPlan plan = test::room();
  plan.push_back({truth * Eigen::Vector2d(0.8, -0.1), truth * Eigen::Vector2d(0.7, 0.9)});
  const auto update = track(slam, scanner.scan(plan, truth, stamp + 1s), odom);
  EXPECT_TRUE(update);
  return {*update, distance_m(update->T_map_base, start.inverse() * truth)};
}

TEST(Slam2d, ASearchAcceptsAPartialFitOnlyAboveMinSearchScore) {
  Slam2dParams params;
  const Found found = after_pause_before_a_board(params);
  EXPECT_EQ(found.update.state, PoseState::kTracking);
  EXPECT_LT(found.update.score, params.doubt.certain_score);
  EXPECT_LT(found.error_m, 0.02);  // two standard deviations of the scan noise
  params.doubt.min_search_score = 0.9;
  EXPECT_EQ(after_pause_before_a_board(params).update.state, PoseState::kLost);
}

// A search near odometry fails where the robot is, because of a board in front of it.
struct FailedSearch {
  FailedSearch() {
    const SE2 step{0.1, 0.0, 0.08};
    auto update = scan(test::room());
    for (int i = 0; i < 20 || (update && !update->is_keyframe); ++i) {
      truth = truth * step;
      odom = odom * step;
      stamp += kPeriod;
      update = scan(test::room());
      EXPECT_TRUE(update);
    }
    with_board.push_back({truth * Eigen::Vector2d(0.8, -0.7), truth * Eigen::Vector2d(0.7, 0.9)});
    for (int i = 0; i < 2; ++i) {
      stamp += kPeriod;
      EXPECT_TRUE(scan(with_board));
    }
    EXPECT_EQ(slam.metrics().searches.made, 1) << "not repeated in the second scan";
  }
  std::optional<PoseUpdate> scan(const test::FloorPlan& plan) {
    return track(slam, scanner.scan(plan, truth, stamp), odom);
  }

  test::Slam slam;
  Scanner scanner;
  const SE2 start{-1.5, -0.5, 0.0};
  SE2 truth = start;
  SE2 odom;
  time::Timestamp stamp{};
  test::FloorPlan with_board = test::room();
};

// During a pause in odometry the robot is carried: that search does not tell where it is now.
TEST(Slam2d, ASearchThatFailedBeforeAPauseInOdometryIsRepeatedAfterIt) {
  FailedSearch run;
  run.truth = run.truth * SE2{-0.9, -2.6, -0.6};
  run.stamp += 2s;
  const auto update = run.scan(test::room());
  ASSERT_TRUE(update);
  EXPECT_EQ(update->state, PoseState::kTracking);
  // Two standard deviations of the scan noise.
  EXPECT_LT(distance_m(update->T_map_base, run.start.inverse() * run.truth), 0.02);
}

// The pause is too short to be noticed, but whoever restarts odometry may have moved the robot.
TEST(Slam2d, ASearchThatFailedBeforeARestartOfOdometryIsRepeatedAfterIt) {
  FailedSearch run;
  run.odom = {};
  run.slam.input.add_odometry(run.stamp + kPeriod / 2, geometry::to_se3(run.odom), true);
  run.stamp += kPeriod;
  EXPECT_TRUE(run.scan(run.with_board));
  EXPECT_EQ(run.slam.metrics().searches.made, 2);
}

// A corridor with a niche on either side every 2 m: each place looks like the one 2 m farther on.
test::FloorPlan corridor_with_equal_niches() {
  test::FloorPlan plan;
  for (const double side : {1.0, -1.0}) {
    for (int i = -15; i < 15; ++i) {
      const double x = 2.0 * i;
      plan.push_back({{x, side}, {x + 1.2, side}});
      plan.push_back({{x + 1.2, side}, {x + 1.2, 1.4 * side}});
      plan.push_back({{x + 1.2, 1.4 * side}, {x + 2.0, 1.4 * side}});
      plan.push_back({{x + 2.0, 1.4 * side}, {x + 2.0, side}});
    }
  }
  return plan;
}

// During a second without data the robot moves on by 2 m, to a place that looks the same, and a
// person stands in front of it. Neither its scans nor the new map that it makes from there
// determine where it is.
TEST(Slam2d, AnAmbiguousPlaceAfterAPauseIsNotTracked) {
  test::Slam slam;
  Scanner scanner;
  const test::FloorPlan plan = corridor_with_equal_niches();
  SE2 truth;
  SE2 odom;
  time::Timestamp stamp{};
  const SE2 step{0.1, 0.0, 0.0};
  std::optional<PoseUpdate> update;
  for (int i = 0; i < 20; ++i) {
    update = track(slam, scanner.scan(plan, truth, stamp), odom);
    truth = truth * step;
    odom = odom * step;
    stamp += kPeriod;
  }
  ASSERT_TRUE(update);
  EXPECT_EQ(update->state, PoseState::kTracking);
  const std::size_t submaps_before = slam.back_end().submaps().size();
  truth = truth * SE2{2.0, 0.0, 0.0};
  stamp += 1s;
  for (int i = 0; i < 25; ++i) {
    test::FloorPlan with_people = plan;
    with_people.push_back({truth * Eigen::Vector2d(0.7, -0.5), truth * Eigen::Vector2d(0.6, 0.4)});
    update = track(slam, scanner.scan(with_people, truth, stamp), odom);
    ASSERT_TRUE(update);
    EXPECT_NE(update->state, PoseState::kTracking) << i;
    truth = truth * step;
    odom = odom * step;
    stamp += kPeriod;
  }
  EXPECT_GT(slam.back_end().submaps().size(), submaps_before);
  EXPECT_GT(update->covariance(0, 0), 1.0);
}

}  // namespace doubt_test
}  // namespace nodmap::slam2d
