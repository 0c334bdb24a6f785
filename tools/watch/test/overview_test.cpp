// SPDX-License-Identifier: BSD-3-Clause
#include "tools/watch/overview.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace nodmap::watch {
namespace overview_test {

using ::testing::HasSubstr;
using ::testing::Not;

odometry_t odometry_at(double x_m, double y_m, double forward_mps) {
  odometry_t message{};
  message.position_m[0] = x_m;
  message.position_m[1] = y_m;
  message.forward_mps = forward_mps;
  return message;
}

time::SteadyTime at(time::Duration since_start) {
  return time::SteadyTime(since_start);
}

TEST(Rate, CountsTheLastSecond) {
  Rate rate;
  for (int i = 0; i < 300; ++i) {
    rate.add(at(i * 10ms));  // 100 per second
  }
  EXPECT_EQ(rate.total(), 300);
  EXPECT_DOUBLE_EQ(rate.per_second(at(2990ms)), 100.0);
  EXPECT_DOUBLE_EQ(rate.per_second(at(3490ms)), 50.0);
  EXPECT_DOUBLE_EQ(rate.per_second(at(9s)), 0.0);
}

TEST(Overview, AddsUpTheDistanceWithoutJumps) {
  Overview overview;
  overview.add(odometry_at(5.0, 5.0, 0.0), at(0s));  // the first position adds no distance
  overview.add(odometry_at(5.3, 5.4, -1.5), at(1us));
  overview.add(odometry_at(0.0, 0.0, 0.0), at(2us));  // the driver was restarted
  overview.add(odometry_at(0.0, 0.1, 0.5), at(3us));
  EXPECT_NEAR(overview.distance_m(), 0.6, 1e-12);
  EXPECT_DOUBLE_EQ(overview.forward_mps(), 0.5);
  EXPECT_DOUBLE_EQ(overview.max_forward_mps(), 1.5);
}

TEST(Overview, NearestIsOfTheNewestMap) {
  Overview overview;
  EXPECT_TRUE(std::isinf(overview.nearest_m()));
  egomap_t map{};
  map.distance_m = {INFINITY, 0.5F, 2.0F};
  overview.add(map, at(0s));
  EXPECT_DOUBLE_EQ(overview.nearest_m(), 0.5);
  map.distance_m = {INFINITY, INFINITY, 2.0F};
  overview.add(map, at(1us));
  EXPECT_DOUBLE_EQ(overview.nearest_m(), 2.0);
}

TEST(Overview, SumsTheLossesInTheNewestStatusOfEachProcess) {
  Overview overview;
  status_t status{};
  status.process_name = std::string("nodmap-a");
  status.total_lost = 3;
  overview.add(status, at(0s));
  status.total_lost = 5;
  overview.add(status, at(1us));
  status.process_name = std::string("nodmap-b");
  status.total_corrupt = 1;
  overview.add(status, at(2us));
  EXPECT_EQ(overview.lost(), 11);
}

TEST(Overview, CountsKeyframesNotTheirParts) {
  Overview overview;
  cloud_chunk_t chunk{};
  for (const std::int64_t id : {0, 0, 1, 1, 1}) {
    chunk.keyframe_id = id;
    overview.add(chunk, at(0s));
  }
  EXPECT_EQ(overview.keyframes(), 2);
  chunk.keyframe_id = 0;  // another map
  overview.add(chunk, at(1s));
  EXPECT_EQ(overview.keyframes(), 1);
}

TEST(StatusLine, SaysWhatTheRobotDoes) {
  Overview overview;
  navigation_t navigation{};
  navigation.behaviour = navigation_t::TURN;
  overview.add(navigation, at(0s));
  pitch_state_t pitch{};
  pitch.pitch_rad = -0.5;
  overview.add(pitch, at(0s));
  odometry_t odometry = odometry_at(0, 0, 1.25);
  odometry.yaw_rate_rad_s = -0.5;
  overview.add(odometry, at(0s));
  EXPECT_THAT(status_line(overview, at(0s)), HasSubstr("TURN"));
  EXPECT_THAT(status_line(overview, at(0s)), HasSubstr("1.25 m/s"));
  EXPECT_THAT(status_line(overview, at(0s)), HasSubstr("m/s  -29 deg/s  pitch -28.6 deg"));
  EXPECT_THAT(status_line(overview, at(0s)), Not(HasSubstr("collisions")));
  truth_t truth{};
  truth.collisions = 2;
  overview.add(truth, at(0s));
  EXPECT_THAT(status_line(overview, at(0s)), HasSubstr("collisions 2"));
  EXPECT_LE(status_line(overview, at(0s)).size(), 132U);
}

TEST(StatusLine, NamesNoBehaviourWithoutANavigator) {
  Overview overview;
  overview.add(odometry_at(0, 0, 0.5), at(0s));
  EXPECT_TRUE(status_line(overview, at(0s)).starts_with("-  "));
  EXPECT_THAT(status_line(overview, at(0s)), Not(HasSubstr("HALT")));
}

TEST(Overview, AnExplorationThatEndsBeforeTheRobotIsHomeWasGivenUp) {
  Overview overview;
  const auto report = [&overview](std::int8_t state) {
    exploration_t message{};
    message.state = state;
    message.reason = "there is no path home";
    overview.add(message, at(0s));
    return overview.given_up();
  };
  EXPECT_FALSE(report(exploration_t::IDLE)) << "not begun yet";
  EXPECT_FALSE(report(exploration_t::EXPLORING));
  EXPECT_FALSE(report(exploration_t::RETURNING));
  EXPECT_EQ(report(exploration_t::IDLE), "there is no path home");
  EXPECT_FALSE(report(exploration_t::HOME));
}

TEST(StatusLine, NamesTheBehaviour) {
  Overview overview;
  navigation_t navigation{};
  for (const auto& [behaviour, name] :
       {std::pair<std::int8_t, const char*>(navigation_t::HALT, "HALT"), {-1, "UNKNOWN"}}) {
    navigation.behaviour = behaviour;
    overview.add(navigation, at(0s));
    EXPECT_TRUE(status_line(overview, at(0s)).starts_with(name));
  }
}

}  // namespace overview_test
}  // namespace nodmap::watch
