// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/inputs/inhibit_reason.hpp"

#include <gtest/gtest.h>

#include "modules/navigator/behaviours/corridor.hpp"
#include "modules/navigator/geofence.hpp"

namespace nodmap::navigator {
namespace inhibit_reason_test {

class InhibitReasonTest : public ::testing::Test {
 protected:
  // Fresh inputs, at the origin.
  InhibitReasonTest() {
    const time::Timestamp now(100s);
    inputs_.stamps = {now, now, now, now, now};
    inputs_.odometry = Inputs::Odometry{};
    inputs_.map = Inputs::ObstacleMap{};
  }

  [[nodiscard]] std::optional<Reason> reason(
      const std::optional<std::string>& contested_channel = {}) const {
    return inhibit_reason(inputs_, contested_channel, params_, params_.staleness);
  }

  NavigatorParams params_;
  Geofence fence_{"POLYGON((-2 -2, 2 -2, 2 2, -2 2))"};
  Inputs inputs_;
};

TEST_F(InhibitReasonTest, FreshInputsHaveNone) {
  EXPECT_EQ(reason(), std::nullopt);
}

TEST_F(InhibitReasonTest, EachHasItsOwn) {
  EXPECT_EQ(reason("SCAN"), Reason(Why::kTwoSenders, "SCAN"));
  inputs_.servo_is_stalled = true;
  EXPECT_EQ(reason(), Reason(Why::kStalledServo));
  inputs_.stamps.scan.reset();
  EXPECT_EQ(reason()->why, Why::kNoInput);
  inputs_.stopped_by = "page";
  EXPECT_EQ(reason(), Reason(Why::kStopped, "page")) << "the one that a person has given";
}

TEST_F(InhibitReasonTest, ALostPoseIsOneOnlyOnTheWayToAGoal) {
  inputs_.pose.is_lost = true;
  EXPECT_EQ(reason(), std::nullopt);
  inputs_.goal.emplace();
  EXPECT_EQ(reason(), Reason(Why::kLostPose));
}

TEST_F(InhibitReasonTest, AGoalWithAHeadingNeedsPlannerAndLocalMap) {
  inputs_.goal = {{}, 0.1, 0.02};
  EXPECT_EQ(reason(), std::nullopt);
  params_.planner.use = false;
  EXPECT_EQ(reason(), Reason(Why::kDocksByPlanOnly));
  params_.planner.use = true;
  params_.local_map.use = false;
  EXPECT_EQ(reason(), Reason(Why::kDocksByPlanOnly));
}

// The base drives 5.2 m/s at most, and the map's pose is accurate to 10 cm: 0.36 m in 50 ms.
TEST_F(InhibitReasonTest, AMapFromTooFarAwayIsOfAnotherOdometry) {
  *inputs_.stamps.map -= 50ms;
  inputs_.map->T_odom_map.x = -0.355;
  EXPECT_EQ(reason(), std::nullopt);
  inputs_.map->T_odom_map.x = -0.365;
  EXPECT_EQ(reason(), Reason(Why::kMapMisfit));
}

TEST_F(InhibitReasonTest, WithAGeofenceItMustKnowThatItIsInside) {
  inputs_.geofence = &fence_;
  EXPECT_EQ(reason(), Reason(Why::kNoPoseInFence));
  inputs_.pose.stamp = *inputs_.stamps.odometry - 2s;
  EXPECT_EQ(reason(), std::nullopt);
  *inputs_.pose.stamp -= 1us;
  EXPECT_EQ(reason(), Reason(Why::kNoPoseInFence));
  inputs_.pose.stamp = inputs_.stamps.odometry;
  inputs_.pose.is_lost = true;
  EXPECT_EQ(reason(), Reason(Why::kNoPoseInFence));
  inputs_.pose.is_lost = false;
  inputs_.goal = {{3.0, 0.0, 0.0}, 0.1, std::nullopt};
  EXPECT_EQ(reason(), Reason(Why::kGoalOutsideFence));
  inputs_.pose.T_map_odom.y = 2.1;
  EXPECT_EQ(reason(), Reason(Why::kOutsideFence));
}

// From there on Brake takes the boundary for an error of the map.
TEST_F(InhibitReasonTest, ItIsOutsideAGeofenceThatCrossesItsBody) {
  inputs_.geofence = &fence_;
  inputs_.pose.stamp = inputs_.stamps.odometry;
  const double touches_m = 2.0 - params_.robot.body.footprint().half_length_m;
  inputs_.pose.T_map_odom.x = touches_m + kErrorOfMapM - 1e-6;
  EXPECT_EQ(reason(), std::nullopt);
  inputs_.pose.T_map_odom.x = touches_m + kErrorOfMapM + 1e-6;
  EXPECT_EQ(reason(), Reason(Why::kOutsideFence));
}

}  // namespace inhibit_reason_test
}  // namespace nodmap::navigator
