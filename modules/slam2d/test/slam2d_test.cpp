// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/slam2d.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "modules/slam2d/test/drawn_world.hpp"
#include "modules/slam2d/test/track.hpp"

namespace nodmap::slam2d {
namespace slam2d_test {

using geometry::SE2;
using test::kPeriod;
using test::Scanner;
using test::track;

// The map that scans are matched against.
std::span<const MapPoint> points_of(const Slam2d& slam) {
  return slam.back_end().local().points.points();
}

// These tests must pass with the default metric, which is not the paper's, and with the paper's
// metric.
class Slam2dMetric : public testing::TestWithParam<ErrorMetric> {
 protected:
  [[nodiscard]] static Slam2dParams params() { return {.matcher = {.metric = GetParam()}}; }
};

INSTANTIATE_TEST_SUITE_P(Metrics, Slam2dMetric,
                         testing::Values(ErrorMetric::kPointToLine, ErrorMetric::kPointToPoint),
                         [](const auto& metric) {
                           return metric.param == Slam2dParams{}.matcher.metric ? "Default"
                                                                                : "Paper";
                         });

// Odometry drifts by 4 % and by 8 degrees per rotation of 60 degrees, and once jumps by 0.2 m, as
// when wheels slip. The correction absorbs all of it, at the scans and between them; odom is never
// changed.
TEST_P(Slam2dMetric, R34_TheCorrectionAbsorbsDriftAndJumpsOfOdometry) {
  test::Slam slam{params()};
  Scanner scanner;
  SE2 truth;
  SE2 odom;
  const SE2 half_step{0.015, 0.0, 0.02};
  const SE2 drift{0.002, 0.001, 0.004};
  double worst_m = 0.0;
  double worst_between_m = 0.0;
  for (int i = 0; i < 150; ++i) {
    const auto update =
        track(slam, scanner.scan(test::room(), truth, time::Timestamp(kPeriod * i)), odom);
    ASSERT_TRUE(update);
    EXPECT_EQ(update->state, PoseState::kTracking);
    worst_m = std::max(worst_m, distance_m(update->T_map_base, truth));
    truth = truth * half_step;
    odom = odom * half_step;
    worst_between_m = std::max(worst_between_m, distance_m(update->T_map_odom * odom, truth));
    truth = truth * half_step;
    odom = odom * half_step * drift;
    if (i == 75) {
      odom = odom * SE2{0.2, 0.0, 0.0};
    }
  }
  // Measured: 8.7 mm with the default metric, 14.8 mm with the paper's, from scan noise of 1 cm. A
  // submap holds fewer scans than one map of all would, which averages less of the noise away.
  const double bound_m = GetParam() == ErrorMetric::kPointToLine ? 0.0108 : 0.0184;
  EXPECT_LT(worst_m, bound_m);
  EXPECT_LT(worst_between_m, bound_m);
  EXPECT_GT(distance_m(odom, truth), 0.2);
}

// Adds the scans of a robot that is stationary for 60 s, while its odometry jitters by 1 mm.
void stay_in_place(test::Slam& slam) {
  Scanner scanner;
  for (int i = 0; i < 60 * 5; ++i) {
    const SE2 odom{0.001 * (i % 2), 0.0, 0.0};
    ASSERT_TRUE(track(slam, scanner.scan(test::room(), {}, time::Timestamp(kPeriod * i)), odom));
  }
}

TEST_P(Slam2dMetric, R36_AStationaryRobotAddsNoKeyframe) {
  test::Slam slam{params()};
  stay_in_place(slam);
  EXPECT_EQ(slam.tracked_scans().size(), 300U);
  EXPECT_EQ(slam.keyframes().size(), 1U);
}

// Here every scan becomes a keyframe, so that only d_new keeps the map from growing; the limit of 1
// % in R36 is meant for this rule and that of the keyframes together. The noise of 300 scans moves
// some points beyond d_new: they add 9 points to the 163 of the first scan with the default metric,
// and 10 with the paper's.
TEST_P(Slam2dMetric, R36_PointsWithACorrespondenceDoNotGrowTheMap) {
  Slam2dParams params = this->params();
  params.keyframe.distance_m = 0.0;
  params.back_end.submap.max_keyframes_per_place = 0;
  test::Slam first{params};
  ASSERT_TRUE(track(first, Scanner().scan(test::room(), {}), {}));
  test::Slam slam{params};
  stay_in_place(slam);
  ASSERT_EQ(slam.keyframes().size(), 300U);
  EXPECT_LE(points_of(slam).size(), points_of(first).size() + 12);
}

// The number of keyframes of a drive with nine level scans, 0.25 m apart. The laser nods by this
// angle from scan to scan, or is held level if it is 0.
std::size_t num_keyframes(double pitch_step_deg) {
  test::Slam slam;
  Scanner scanner;
  SE2 truth{-1.5, -0.5, 0.0};
  const double step_rad = geometry::deg_to_rad(pitch_step_deg);
  const int num_scans = pitch_step_deg > 0.0 ? 5 : 1;  // of each sweep, the level one amid
  double pitch_rad = 2.7 * step_rad;
  for (int i = 0; i < 9; ++i) {
    const double direction = i % 2 == 0 ? -1.0 : 1.0;
    int num_updates = 0;
    for (int k = 0; k < num_scans; ++k) {
      scan::Scan scan = scanner.scan(test::room(), truth, time::Timestamp(kPeriod * i + 13ms * k));
      scan.pitch_first_rad = pitch_rad;
      pitch_rad += direction * step_rad;
      scan.pitch_last_rad = pitch_rad;
      num_updates += track(slam, scan, truth) ? 1 : 0;
    }
    EXPECT_EQ(num_updates, 1);
    pitch_rad += direction * 0.4 * step_rad;  // the sweep goes on to its reversal
    truth = truth * SE2{0.25, 0.0, 0.0};
  }
  return slam.keyframes().size();
}

TEST(Slam2d, EveryLevelScanOfANodBecomesAKeyframeWhileDriving) {
  EXPECT_EQ(num_keyframes(1.0), 9U);
  EXPECT_EQ(num_keyframes(0.0), 5U);
}

TEST(Slam2d, R36_NoTwoPointsOfTheMapAreNearerThanDNew) {
  const Slam2dParams params;
  test::Slam slam{params};
  Scanner scanner;
  SE2 truth;
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(
        track(slam, scanner.scan(test::room(), truth, time::Timestamp(kPeriod * i)), truth));
    truth = truth * SE2{0.03, 0.0, 0.04};
  }
  EXPECT_GT(slam.keyframes().size(), 10U);
  const auto points = points_of(slam);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      ASSERT_GT((points[i].point.p - points[j].point.p).norm(), params.map.new_point_distance_m);
    }
  }
}

TEST(Slam2d, R37_InACorridorThePoseFollowsOdometryAlongAndTheWallsAcross) {
  test::Slam slam;
  Scanner scanner;
  SE2 truth;
  SE2 odom;
  std::optional<PoseUpdate> update;
  for (int i = 0; i <= 300; ++i) {
    update = track(slam, scanner.scan(test::corridor(), truth, time::Timestamp(kPeriod * i)), odom);
    ASSERT_TRUE(update);
    truth.x += 0.1;
    odom = odom * SE2{0.103, 0.0, 0.002};  // 3 % too long, rotates by 1.1 degrees per metre
  }
  EXPECT_EQ(update->state, PoseState::kDegraded);
  // The position along the corridor comes from odometry alone, which is 3 % too long. Matching must
  // not move the robot back, as scan matching in corridors often does, nor forward. R37 allows 0.3
  // m in 30 m, 0.1 m across and 0.5 degrees. Measured: 0.4 mm along, 25 mm across, because submaps
  // drift a little across, and 0.053 degrees.
  EXPECT_NEAR(update->T_map_base.x, 30.0 * 1.03, 0.0005);
  EXPECT_NEAR(update->T_map_base.y, 0.0, 0.0315);
  EXPECT_NEAR(update->T_map_base.yaw, 0.0, geometry::deg_to_rad(0.065));
}

// The largest heading error on a drive through the corridor with doors.
double worst_heading_rad(const Slam2dParams& params) {
  test::Slam slam{params};
  Scanner scanner;
  double worst_rad = 0.0;
  for (int i = 0; i < 75; ++i) {
    const SE2 truth{0.36 * i, 0.0, 0.0};  // 1.5 m/s, a level scan each 0.24 s
    const SE2 odom{1.03 * truth.x, 0.0, 0.0005 * i};
    const auto update = track(
        slam, scanner.scan(test::corridor_with_doors(), truth, time::Timestamp(kPeriod * i)), odom);
    worst_rad = std::max(worst_rad, std::abs(update.value().T_map_base.yaw));
  }
  return worst_rad;
}

// A map line that spans the step at a door frame is slanted, and scans that are matched with it
// rotate the pose.
TEST(Slam2d, R37_DoorFramesDoNotRotateThePose) {
  const double worst_rad = worst_heading_rad({});
  const double worst_with_wide_lines_rad = worst_heading_rad({.map = {.line_radius_m = 0.25}});
  EXPECT_LT(worst_rad, geometry::deg_to_rad(0.114));  // measured 0.092; R37 allows 0.5
  EXPECT_LT(worst_rad, worst_with_wide_lines_rad);
}

// The steps of a drive once around the ring corridor, from the middle of its first side: 0.1 m
// each, and 9 degrees at the corners.
std::vector<SE2> steps_around_ring() {
  std::vector<SE2> steps(70, {0.1, 0.0, 0.0});
  for (const std::size_t side_steps : {100U, 140U, 100U, 70U}) {
    steps.insert(steps.end(), 10, {0.0, 0.0, geometry::deg_to_rad(9.0)});
    steps.insert(steps.end(), side_steps, {0.1, 0.0, 0.0});
  }
  return steps;
}

// Odometry is 3 % too long, and the error of its heading is a random walk of 1 degree per square
// root of a metre.
TEST(Slam2d, R38_ALoopOf48MetresEndsWhereItBegan) {
  test::Slam slam;
  Scanner scanner;
  std::mt19937 random(38);
  std::normal_distribution<double> unit(0.0, 1.0);
  const SE2 start{7.0, 0.0, 0.0};
  SE2 truth = start;
  SE2 odom = start;
  std::optional<PoseUpdate> update;
  time::Timestamp stamp{};
  for (const SE2& step : steps_around_ring()) {
    truth = truth * step;
    const double walk_rad = geometry::deg_to_rad(1.0) * std::sqrt(step.x) * unit(random);
    odom = odom * SE2{1.03 * step.x, 0.0, step.yaw + walk_rad};
    update = track(slam, scanner.scan(test::ring_corridor(), truth, stamp), odom);
    ASSERT_TRUE(update);
    stamp += kPeriod;
  }
  ASSERT_LT(distance_m(truth, start), 1e-9);
  // R38 allows 0.10 m and 1 degree. Measured: 16.8 mm and 0.23 degrees; by odometry alone 1.39 m.
  // The last scans are matched against the last submap, which loops have moved onto the first.
  EXPECT_LT(distance_m(update->T_map_base, start), 0.021);
  EXPECT_NEAR(update->T_map_base.yaw, 0.0, geometry::deg_to_rad(0.28));
  slam.finish_loops();
  slam.polish();
  const SE2 polished = slam.trajectory().back();
  // Measured: 2.3 mm and 0.05 degrees.
  EXPECT_LT(distance_m(polished, start), 0.0028);
  EXPECT_NEAR(polished.yaw, 0.0, geometry::deg_to_rad(0.056));
  EXPECT_GT(distance_m(odom, start), 1.0);
}

TEST(Slam2d, RejectsBadInputWithoutChangingTheMap) {
  test::Slam slam;
  Scanner scanner;
  scan::Scan empty = scanner.scan(test::room(), {});
  empty.ranges_m.clear();
  EXPECT_FALSE(track(slam, empty, {}));  // no points to begin a map with

  const scan::Scan good = scanner.scan(test::room(), {}, time::Timestamp(kPeriod));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(track(slam, good, {kNan, 0.0, 0.0}));
  slam.input.stop_waiting();
  scan::Scan broken = good;
  broken.angle_step_rad = kNan;
  EXPECT_FALSE(track(slam, broken, {}));
  EXPECT_TRUE(slam.keyframes().empty());

  ASSERT_TRUE(track(slam, good, {}));
  const std::size_t size = points_of(slam).size();
  scan::Scan blind = good;
  blind.ranges_m.assign(181, std::numeric_limits<float>::quiet_NaN());
  const auto update = track(slam, blind, {0.2, 0.0, 0.0});
  ASSERT_TRUE(update);
  EXPECT_EQ(update->state, PoseState::kOdometry);
  EXPECT_EQ(update->T_map_base.x, 0.2);
  EXPECT_EQ(points_of(slam).size(), size);
}

// Along a bare corridor the pose follows odometry, whose frame changes under way.
TEST(Slam2d, ARestartOfOdometryChangesNeitherThePathByOdometryNorTheCovariance) {
  const auto drive = [](const SE2& T_new_old) {
    test::Slam slam;
    Scanner scanner(0.0);
    PoseUpdate update;
    for (int i = 0; i <= 100; ++i) {
      const SE2 truth{0.08 * i, 0.0, 0.0};
      if (i == 51) {  // with a keyframe before and after
        const SE2 before{0.08 * (i - 1), 0.0, 0.0};
        slam.input.add_odometry(time::Timestamp(kPeriod * i - 10ms),
                                geometry::to_se3(T_new_old * before), true);
      }
      const scan::Scan scan = scanner.scan(test::corridor(), truth, time::Timestamp(kPeriod * i));
      update = track(slam, scan, i <= 50 ? truth : T_new_old * truth).value_or(PoseUpdate{});
    }
    return std::pair{slam.keyframes().back().T_odom_base, update.covariance};
  };
  const auto [path_end, covariance] = drive({});
  const auto [path_end_restarted, covariance_restarted] = drive({-40.0, 20.0, 2.0});
  EXPECT_LT(distance_m(path_end, path_end_restarted), 1e-9);
  EXPECT_GT(covariance(0, 0), 0.0);
  EXPECT_TRUE(covariance.isApprox(covariance_restarted, 1e-6));
}

// The scans have no points: that says nothing about the pose, but odometry suffices for 10 m only.
TEST(Slam2d, WithoutEchoesTheRobotIsLostAfterTenMetres) {
  test::Slam slam;
  Scanner scanner;
  ASSERT_TRUE(track(slam, scanner.scan(test::room(), {}), {}));
  for (int i = 1; i <= 120; ++i) {
    const SE2 odom{0.1 * i, 0.0, 0.0};
    const auto update = track(slam, scanner.scan({}, odom, time::Timestamp(kPeriod * i)), odom);
    ASSERT_TRUE(update);
    if (i < 95 || i > 105) {
      EXPECT_EQ(update->state, i < 95 ? PoseState::kOdometry : PoseState::kLost) << i;
    }
  }
}

TEST(Slam2d, ScansKeepTheirOrderAndStampsWhenTimeStepsBack) {
  test::Slam slam;
  Scanner scanner;
  for (const time::Duration since_start : {1000ms, 1200ms, 300ms, 1400ms}) {
    const time::Timestamp stamp(since_start);
    const auto update = track(slam, scanner.scan(test::room(), {}, stamp), {});
    ASSERT_TRUE(update);
    EXPECT_EQ(update->stamp, stamp);
    EXPECT_EQ(slam.tracked_scans().back().stamp, stamp);
  }
}

TEST(Slam2d, UntilKeyframesMoveTheTrajectoryEqualsTheOnlinePoses) {
  test::Slam slam;
  Scanner scanner;
  SE2 truth;
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(
        track(slam, scanner.scan(test::room(), truth, time::Timestamp(kPeriod * i)), truth));
    truth = truth * SE2{0.03, 0.0, 0.04};
  }
  const std::vector<SE2> trajectory = slam.trajectory();
  ASSERT_EQ(trajectory.size(), 50U);
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    EXPECT_LT(distance_m(trajectory[i], slam.tracked_scans()[i].T_map_base_online), 1e-9);
  }
}

TEST(Slam2d, TheSameScansGiveTheSamePoses) {
  const auto run = [] {
    test::Slam slam;
    Scanner scanner;
    SE2 truth;
    for (int i = 0; i < 60; ++i) {
      track(slam, scanner.scan(test::room(), truth, time::Timestamp(kPeriod * i)),
            {0.9 * truth.x, truth.y, truth.yaw});
      truth = truth * SE2{0.03, 0.0, 0.04};
    }
    return slam.tracked_scans().back().T_map_base_online;
  };
  const SE2 a = run();
  const SE2 b = run();
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  EXPECT_EQ(a.yaw, b.yaw);
}

}  // namespace slam2d_test
}  // namespace nodmap::slam2d
