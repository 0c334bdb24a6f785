// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/localise/localiser.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "modules/slam2d/scan/level_scan_input.hpp"
#include "modules/slam2d/test/drawn_world.hpp"

namespace nodmap::slam2d {
namespace localiser_test {

using geometry::SE2;

// The map of room().
KnownMap map_of_room() {
  return {trinary(test::drawn_grid(test::room(), test::poses_in_room())), {}};
}

// A robot with 5 scans a second and odometry that counts 3 % too much.
class Drive {
 public:
  Drive(const KnownMap& map, const std::optional<SE2>& start, const Slam2dParams& params = {})
      : input_(params.level_scans), localiser_(params, map, start) {}

  // Odometry is absent for a time, in which the robot moves.
  void move_unseen(const SE2& motion, time::Duration duration) {
    truth = truth * motion;
    stamp_ += duration;
  }

  // Drives one step and takes a scan. Returns the resulting pose.
  PoseUpdate step(const SE2& motion) {
    truth = truth * motion;
    odom_ = odom_ * SE2{1.03 * motion.x, 1.03 * motion.y, motion.yaw};
    return stand();
  }
  PoseUpdate stand() {
    stamp_ += 200ms;
    input_.add_odometry(stamp_, geometry::to_se3(odom_));
    input_.add_scan(scanner_.scan(plan, truth, stamp_));
    const auto scan = input_.next();
    return scan ? localiser_.add_scan(*scan) : PoseUpdate{};
  }
  // The base driver restarts: odometry begins anew.
  void restart_odometry() {
    odom_ = {};
    input_.add_odometry(stamp_ + 100ms, geometry::to_se3(odom_), true);
  }
  [[nodiscard]] double error_m(const PoseUpdate& update) const {
    return (update.T_map_base.translation() - truth.translation()).norm();
  }
  [[nodiscard]] const LocaliserMetrics& metrics() const { return localiser_.metrics(); }

  SE2 truth;
  test::FloorPlan plan = test::room();

 private:
  LevelScanInput input_;
  Localiser localiser_;
  test::Scanner scanner_;
  SE2 odom_{7.0, -3.0, 1.0};  // odometry begins anywhere
  time::Timestamp stamp_{};
};

constexpr double kMaxErrorM = 0.05;  // a cell of the map

TEST(Localiser, FollowsTheRobotFromAGivenPose) {
  const KnownMap map = map_of_room();
  Drive drive(map, SE2{0.1, -0.1, 0.05});  // roughly given
  for (int i = 0; i < 100; ++i) {
    const PoseUpdate update = drive.step({0.04, 0.0, 0.06});
    EXPECT_EQ(update.state, PoseState::kTracking);
    EXPECT_LT(drive.error_m(update), kMaxErrorM) << i;
  }
  EXPECT_EQ(drive.metrics().searches.made, 0);
  EXPECT_EQ(drive.metrics().scans.tracked, 100);
}

TEST(Localiser, APlaceFoundWithoutAStartPoseIsTrackedAfterDriving) {
  const KnownMap map = map_of_room();
  Drive drive(map, std::nullopt);
  drive.truth = {1.0, -0.5, 2.0};
  const PoseUpdate first = drive.stand();
  EXPECT_EQ(first.state, PoseState::kDegraded);
  EXPECT_LT(drive.error_m(first), kMaxErrorM);
  PoseUpdate update;
  for (int i = 0; i < 15; ++i) {  // 0.6 m
    update = drive.step({0.04, 0.0, 0.03});
    EXPECT_LT(drive.error_m(update), kMaxErrorM);
  }
  EXPECT_EQ(update.state, PoseState::kTracking);
  EXPECT_EQ(drive.metrics().searches.made, 1);
}

// The robot is carried away, and odometry does not notice it.
TEST(Localiser, AKidnappedRobotReportsThatItIsLostAndFindsItsPlaceAgain) {
  const KnownMap map = map_of_room();
  int lost = 0;
  for (const SE2& elsewhere : {SE2{1.0, -1.0, 2.6}, SE2{-2.0, 2.0, -1.0}, SE2{3.7, 2.5, 3.0}}) {
    Drive drive(map, SE2{});
    for (int i = 0; i < 10; ++i) {
      ASSERT_EQ(drive.step({0.04, 0.0, 0.05}).state, PoseState::kTracking);
    }
    drive.truth = elsewhere;
    bool said_lost = false;
    PoseUpdate update;
    for (int i = 0; i < 50; ++i) {  // 10 s of driving in a circle of 0.4 m
      update = drive.step({0.04, 0.0, 0.1});
      const bool is_wrong = drive.error_m(update) > 0.25;
      said_lost = said_lost || update.state == PoseState::kLost;
      // A wrong pose is never TRACKING, and after 3 s it is LOST.
      EXPECT_FALSE(is_wrong && i >= 15 && update.state != PoseState::kLost) << i;
      EXPECT_FALSE(is_wrong && update.state == PoseState::kTracking) << i;
    }
    lost += said_lost ? 1 : 0;
    EXPECT_EQ(update.state, PoseState::kTracking);
    EXPECT_LT(drive.error_m(update), kMaxErrorM);
  }
  EXPECT_EQ(lost, 3);
}

// What a search finds need not suffice for tracking. Then the search has failed, too, and is
// repeated once a second while the robot is stationary.
TEST(Localiser, APlaceThatIsNotAcceptedIsNotSearchedForWithEachScan) {
  const KnownMap map = map_of_room();
  Drive drive(map, std::nullopt, {.localise = {.min_score = 1.0}});
  drive.truth = {1.0, -0.5, 2.0};
  for (int i = 0; i < 10; ++i) {  // 2 s
    EXPECT_EQ(drive.stand().state, PoseState::kLost);
  }
  EXPECT_EQ(drive.metrics().searches.made, 2);
  EXPECT_EQ(drive.metrics().searches.found, 0);
  EXPECT_EQ(drive.metrics().times_lost, 0);
}

// Meanwhile somebody may have carried the robot.
TEST(Localiser, ASearchThatFailedBeforeARestartOfOdometryIsRepeatedAfterIt) {
  const KnownMap map = map_of_room();
  Drive drive(map, std::nullopt, {.localise = {.min_score = 1.0}});
  drive.stand();
  drive.stand();
  ASSERT_EQ(drive.metrics().searches.made, 1);
  drive.restart_odometry();
  drive.stand();
  EXPECT_EQ(drive.metrics().searches.made, 2);
}

// Another building is never taken for the known one.
TEST(Localiser, InAnotherBuildingTheRobotIsNeverTracked) {
  const KnownMap map = map_of_room();
  Drive drive(map, std::nullopt);
  drive.plan = test::ring_corridor();
  for (int i = 0; i < 50; ++i) {
    EXPECT_NE(drive.step({0.1, 0.0, 0.0}).state, PoseState::kTracking);
  }
  EXPECT_GT(drive.metrics().scans.lost, 40);
}

// The lens is dirty. As long as the robot is stationary, odometry suffices; after 10 m it does not.
TEST(Localiser, WithoutEchoesTheRobotIsLostAfterTenMetres) {
  const KnownMap map = map_of_room();
  Drive drive(map, SE2{});
  EXPECT_EQ(drive.stand().state, PoseState::kTracking);
  drive.plan.clear();
  for (int i = 0; i < 300; ++i) {
    EXPECT_EQ(drive.stand().state, PoseState::kOdometry);
  }
  for (int i = 0; i < 90; ++i) {
    EXPECT_EQ(drive.step({0.1, 0.0, 0.0}).state, PoseState::kOdometry) << i;
  }
  for (int i = 0; i < 20; ++i) {
    drive.step({0.1, 0.0, 0.0});
  }
  EXPECT_EQ(drive.stand().state, PoseState::kLost);
  EXPECT_EQ(drive.metrics().times_lost, 1);
}

// The base driver is away while the robot is pushed along a bare corridor. The scan fits wherever
// it may be.
TEST(Localiser, AfterAGapInOdometryTheCovarianceIncludesThePossibleMotion) {
  std::vector<SE2> poses;
  for (double x = 0.0; x < 20.0; x += 0.5) {
    poses.push_back({x, 0.0, 0.0});
    poses.push_back({x, 0.0, geometry::kPi});
  }
  const KnownMap map{trinary(test::drawn_grid(test::corridor(), poses)), {}};
  Drive drive(map, SE2{5.0, 0.0, 0.0});
  drive.truth = {5.0, 0.0, 0.0};
  drive.plan = test::corridor();
  for (int i = 0; i < 10; ++i) {
    drive.step({0.04, 0.0, 0.0});
  }
  drive.move_unseen({3.0, 0.0, 0.0}, 5s);
  for (int i = 0; i < 20; ++i) {
    const PoseUpdate update = drive.step({0.04, 0.0, 0.0});
    EXPECT_NE(update.state, PoseState::kTracking);
    if (update.state != PoseState::kLost) {
      EXPECT_LT(drive.error_m(update), 3.0 * std::sqrt(update.covariance(0, 0))) << i;
    }
  }
}

TEST(Localiser, MotionDuringAGapInOdometryIsFoundFromTheScan) {
  const KnownMap map = map_of_room();
  Drive drive(map, SE2{});
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(drive.step({0.04, 0.0, 0.0}).state, PoseState::kTracking);
  }
  drive.move_unseen({2.0, -0.5, 1.2}, 2s);
  PoseUpdate update;
  for (int i = 0; i < 15; ++i) {  // 0.6 m
    update = drive.step({0.04, 0.0, 0.05});
    EXPECT_LT(drive.error_m(update), kMaxErrorM) << i;
    EXPECT_NE(update.state, PoseState::kLost) << i;
  }
  EXPECT_EQ(update.state, PoseState::kTracking);  // confirmed
  EXPECT_EQ(drive.metrics().times_lost, 0);
}

// As in recordings in which odometry comes once a second.
TEST(Localiser, AStationaryRobotStaysTrackedInAGapOfOdometry) {
  const KnownMap map = map_of_room();
  Drive drive(map, SE2{});
  for (int i = 0; i < 10; ++i) {
    drive.move_unseen({}, 1s);
    EXPECT_EQ(drive.stand().state, PoseState::kTracking);
  }
}

TEST(Localiser, ARestartOfOdometryKeepsThePose) {
  const KnownMap map = map_of_room();
  Drive drive(map, SE2{});
  EXPECT_EQ(drive.stand().state, PoseState::kTracking);
  drive.restart_odometry();
  const PoseUpdate update = drive.stand();
  EXPECT_EQ(update.state, PoseState::kTracking);
  EXPECT_LT(drive.error_m(update), kMaxErrorM);
}

// What odometry counted before the first scan is no motion.
TEST(Localiser, WhereOdometryBeginsDoesNotChangeTheCovariance) {
  const KnownMap map = map_of_room();
  const auto first_covariance = [&map](const SE2& T_odom_base) {
    LevelScanInput input({});
    input.add_odometry(time::Timestamp{}, geometry::to_se3(T_odom_base));
    input.add_scan(test::Scanner().scan(test::room(), {}));
    const auto scan = input.next();
    return Localiser({}, map, SE2{}).add_scan(scan.value()).covariance;
  };
  EXPECT_TRUE(first_covariance({100.0, 0.0, 0.0}).isApprox(first_covariance({}), 1e-6));
}

}  // namespace localiser_test
}  // namespace nodmap::slam2d
