// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/remote_control.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "common/bus/live_bus.hpp"

namespace nodmap::viewer {
namespace {

class RemoteControlTest : public ::testing::Test {
 protected:
  std::string ask(const std::string& topic, const Json& request,
                  const std::optional<geometry::SE3>& pose = std::nullopt) {
    const std::string refusal = control_.publish(topic, request, pose);
    while (bus_.handle(std::chrono::milliseconds(0)) > 0) {
    }
    return refusal;
  }

  bus::LiveBus bus_{"memq://"};
  bus::Latest<nodmap::goal_t> goal_{bus_, "GOAL"};
  time::ManualClock clock_{77};
  RemoteControl control_{bus_, clock_};
};

TEST_F(RemoteControlTest, AGoalGoesOut) {
  EXPECT_EQ(ask("GOAL", {{"x_m", 1.5}, {"y_m", -2.0}}), "");
  ASSERT_TRUE(goal_.get());
  EXPECT_TRUE(goal_.get()->is_active);
  EXPECT_DOUBLE_EQ(goal_.get()->position_m[0], 1.5);
  EXPECT_DOUBLE_EQ(goal_.get()->position_m[1], -2.0);
  EXPECT_EQ(goal_.get()->utime, 77);
  EXPECT_EQ(ask("GOAL", {{"clear", true}}), "");
  EXPECT_FALSE(goal_.get()->is_active);
  EXPECT_EQ(goal_.get()->goal_seq, 1);
}

TEST_F(RemoteControlTest, AStopIsAGoalWhereTheRobotIs) {
  geometry::SE3 pose = geometry::SE3::Identity();
  pose.translation() = Eigen::Vector3d(4.0, 5.0, 0.0);
  EXPECT_NE(ask("STOP", Json::object()), "");
  EXPECT_EQ(goal_.count(), 0);
  EXPECT_EQ(ask("STOP", Json::object(), pose), "");
  EXPECT_DOUBLE_EQ(goal_.get()->position_m[1], 5.0);
}

TEST_F(RemoteControlTest, NonsenseIsRefused) {
  for (const Json& request :
       {Json::object(), Json({{"x_m", 1}}), Json({{"x_m", "1"}, {"y_m", 1}}),
        Json({{"x_m", 1e9}, {"y_m", 1}}), Json({{"x_m", 1}, {"y_m", 1}, {"tolerance_m", 0}})}) {
    EXPECT_NE(ask("GOAL", request), "") << request;
  }
  EXPECT_NE(ask("DRIVE", {{"forward_mps", 1}}), "");
  EXPECT_EQ(goal_.count(), 0);
}

}  // namespace
}  // namespace nodmap::viewer
