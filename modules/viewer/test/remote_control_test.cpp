// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/remote_control.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <utility>

#include "common/bus/live_bus.hpp"
#include "nodmap/explore_t.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "nodmap/status_t.hpp"
#include "procman/config/parser.hpp"

namespace nodmap::viewer {
namespace remote_control_test {

class RemoteControlTest : public ::testing::Test {
 protected:
  void handle() {
    while (bus_.handle(std::chrono::milliseconds(0)) > 0) {
    }
  }

  bool ask(const Json& request, time::Duration age = 0s) {
    const Answer answer = control_.answer(request, age);
    EXPECT_FALSE(answer.text.empty());
    answer_ = answer.text;
    handle();
    return answer.ok;
  }

  void pass(time::Duration duration) {
    now_.wall += duration;
    now_.steady += duration;
    control_.poll();
    handle();
  }

  // As long as anything that is asked once is repeated, and longer.
  void pass_ten_seconds() {
    for (int i = 0; i < 100; ++i) {
      pass(100ms);
    }
  }

  void report(const char* process) {
    nodmap::status_t status{};
    status.process_name = process;
    bus_.publish("STATUS", status);
    handle();
  }

  [[nodiscard]] bool answer_has(const char* text) const {
    return answer_.find(text) != std::string::npos;
  }

  bus::LiveBus bus_{"memq://"};
  bus::Latest<nodmap::goal_t> goal_{bus_, "GOAL"};
  bus::Latest<nodmap::explore_t> explore_{bus_, "EXPLORE"};
  bus::Latest<nodmap::stop_t> stop_{bus_, "STOP"};
  bus::Latest<nodmap::save_request_t> save_{bus_, "SAVE_REQUEST"};
  time::Moment now_{time::from_utime(77), time::SteadyTime(5h)};
  RemoteControl control_{bus_, [this] { return now_; }, nullptr};
  std::string answer_;
};

TEST_F(RemoteControlTest, AGoalIsPublished) {
  EXPECT_TRUE(ask({{"do", "goal"}, {"x_m", 1.5}, {"y_m", -2.0}}));
  ASSERT_TRUE(goal_.get());
  EXPECT_TRUE(goal_.get()->is_active);
  EXPECT_DOUBLE_EQ(goal_.get()->position_m[0], 1.5);
  EXPECT_DOUBLE_EQ(goal_.get()->position_m[1], -2.0);
  EXPECT_DOUBLE_EQ(goal_.get()->tolerance_m, 0.3);
  EXPECT_EQ(goal_.get()->utime, 77);
  EXPECT_TRUE(ask({{"do", "roam"}}));
  EXPECT_FALSE(goal_.get()->is_active);
  EXPECT_EQ(goal_.get()->goal_seq, 1);
}

// Where odometry began, which is the map's origin: not where the robot drove last.
TEST_F(RemoteControlTest, HomeIsTheOriginOfTheMap) {
  EXPECT_TRUE(ask({{"do", "goal"}, {"x_m", 1.5}, {"y_m", -2.0}}));
  EXPECT_TRUE(ask({{"do", "home"}}));
  EXPECT_TRUE(answer_has("Goal: home")) << answer_;
  EXPECT_TRUE(goal_.get()->is_active);
  EXPECT_EQ(goal_.get()->position_m[0], 0.0);
  EXPECT_EQ(goal_.get()->position_m[1], 0.0);
  EXPECT_DOUBLE_EQ(goal_.get()->tolerance_m, 0.3);
  EXPECT_FALSE(goal_.get()->has_heading) << "there may be a wall behind it";
  EXPECT_EQ(goal_.get()->goal_seq, 1);
}

TEST_F(RemoteControlTest, AnExplorationIsStartedAndEnded) {
  EXPECT_TRUE(ask({{"do", "explore"}}));
  ASSERT_TRUE(explore_.get());
  EXPECT_TRUE(explore_.get()->is_active);
  EXPECT_EQ(explore_.get()->utime, 77);
  EXPECT_TRUE(ask({{"do", "end_exploration"}}));
  EXPECT_FALSE(explore_.get()->is_active);
  EXPECT_FALSE(goal_.get()) << "the explorer sends the goals";
}

TEST_F(RemoteControlTest, AGoalFarAwayIsRefusedAndOneOutsideTheMapIsReported) {
  EXPECT_FALSE(ask({{"do", "goal"}, {"x_m", 1e9}, {"y_m", 0}}));
  EXPECT_NE(answer_.find("10000 m"), std::string::npos) << answer_;
  EXPECT_FALSE(goal_.get());
  EXPECT_TRUE(ask({{"do", "goal"}, {"x_m", 50}, {"y_m", 0}}));
  EXPECT_EQ(answer_.find("outside"), std::string::npos) << "no map has come";
  nodmap::grid_chunk_t tile{};
  tile.cell_size_m = 0.1;
  tile.origin_x_m = -2.0;
  tile.origin_y_m = -1.0;
  tile.grid_width = 100;  // to x = 8
  tile.grid_height = 30;  // to y = 2
  bus_.publish("MAP_2D", tile);
  handle();
  EXPECT_TRUE(ask({{"do", "goal"}, {"x_m", 7.9}, {"y_m", 1.9}}));
  EXPECT_EQ(answer_.find("outside"), std::string::npos) << answer_;
  EXPECT_TRUE(ask({{"do", "goal"}, {"x_m", 7.9}, {"y_m", 2.1}}));
  EXPECT_NE(answer_.find("outside of the map"), std::string::npos) << answer_;
  EXPECT_DOUBLE_EQ(goal_.get()->position_m[1], 2.1) << "it may still be explored";
}

TEST_F(RemoteControlTest, AStopIsRepeatedUntilTheRobotIsReleased) {
  pass(1s);
  EXPECT_EQ(stop_.count(), 0);  // nobody has asked
  EXPECT_TRUE(ask({{"do", "stop"}}));
  ASSERT_TRUE(stop_.get());
  EXPECT_TRUE(stop_.get()->is_stopped);
  EXPECT_EQ(stop_.get()->requested_by, "nodmap-viewer");
  pass(node::StopSender::kPeriod - 1us);
  EXPECT_EQ(stop_.count(), 1);
  pass(1us);
  EXPECT_EQ(stop_.count(), 2);
  EXPECT_EQ(stop_.get()->stop_seq, 1);
  EXPECT_TRUE(ask({{"do", "goal"}, {"x_m", 1}, {"y_m", 1}}));  // does not release it
  pass(node::StopSender::kPeriod);
  EXPECT_TRUE(stop_.get()->is_stopped);
  EXPECT_TRUE(ask({{"do", "go"}}));
  pass_ten_seconds();
  EXPECT_FALSE(stop_.get()->is_stopped);
}

// One of its messages may be lost, or cross a repetition of the base driver's.
TEST_F(RemoteControlTest, AReleaseIsSentSeveralTimes) {
  EXPECT_TRUE(ask({{"do", "stop"}}));
  const std::int64_t count = stop_.count();
  pass(1ms);
  EXPECT_TRUE(ask({{"do", "go"}}));
  const std::int64_t decided = stop_.get()->utime;
  pass_ten_seconds();
  EXPECT_EQ(stop_.count(), count + node::StopSender::kNumCopies);
  EXPECT_FALSE(stop_.get()->is_stopped);
  EXPECT_EQ(stop_.get()->utime, decided) << "a copy must not lift a STOP of somebody else";
}

// The page shows what STOP itself says, and whether the base driver has confirmed it.
TEST_F(RemoteControlTest, NoAnswerClaimsWhatNobodyHasConfirmed) {
  EXPECT_TRUE(ask({{"do", "stop"}}));
  EXPECT_TRUE(answer_has("STOP is sent")) << answer_;
  EXPECT_TRUE(ask({{"do", "go"}}));
  EXPECT_TRUE(answer_has("Release is sent")) << answer_;
}

TEST_F(RemoteControlTest, AnAnswerSaysIfNobodyReportsWhoCouldDoIt) {
  const std::pair<Json, const char*> recipients[] = {
      {{{"do", "goal"}, {"x_m", 1}, {"y_m", 1}}, "nodmap-navigator"},
      {{{"do", "home"}}, "nodmap-navigator"},
      {{{"do", "roam"}}, "nodmap-navigator"},
      {{{"do", "explore"}}, "nodmap-explorer"},
      {{{"do", "end_exploration"}}, "nodmap-explorer"},
      {{{"do", "stop"}}, "nodmap-kurt"},
      {{{"do", "go"}}, "nodmap-kurt"},
      {{{"do", "save_maps"}}, "nodmap-slam6d"}};
  for (const auto& [request, process] : recipients) {
    EXPECT_TRUE(ask(request));
    EXPECT_TRUE(answer_has("reports")) << answer_;
    report(process);
    EXPECT_TRUE(ask(request));
    EXPECT_FALSE(answer_has("reports")) << answer_;
    pass(5s);  // the process has ended
    EXPECT_TRUE(ask(request));
    EXPECT_TRUE(answer_has("reports")) << answer_;
  }
}

TEST_F(RemoteControlTest, AGoalIsRepeatedUntilTheNavigatorHasTakenIt) {
  EXPECT_TRUE(ask({{"do", "goal"}, {"x_m", 1}, {"y_m", 1}}));
  pass(1s);
  EXPECT_EQ(goal_.count(), 2);
  nodmap::navigation_t navigation{};
  navigation.goal_utime = goal_.get()->utime;
  bus_.publish("NAVIGATION", navigation);
  handle();
  pass_ten_seconds();
  EXPECT_EQ(goal_.count(), 2);
}

// A navigator that is started later must not drive to a place of which nobody thinks any more.
TEST_F(RemoteControlTest, AGoalThatNobodyTakesIsNotRepeatedForLong) {
  for (const Json& request : {Json({{"do", "goal"}, {"x_m", 1}, {"y_m", 1}}),
                              Json({{"do", "home"}}), Json({{"do", "roam"}})}) {
    const std::int64_t count = goal_.count();
    EXPECT_TRUE(ask(request));
    pass_ten_seconds();
    EXPECT_EQ(goal_.count() - count, 3) << "at once, after one second and after two";
  }
}

// The 2 s are over, although by the wall clock they seem to lie ahead.
TEST_F(RemoteControlTest, AClockThatIsSetBackDoesNotProlongAGoal) {
  EXPECT_TRUE(ask({{"do", "goal"}, {"x_m", 1}, {"y_m", 1}}));
  pass(1900ms);
  const std::int64_t count = goal_.count();
  now_.wall -= 3s;
  pass(200ms);
  pass_ten_seconds();
  EXPECT_EQ(goal_.count(), count);
}

TEST_F(RemoteControlTest, AClockThatIsSetSilencesNobody) {
  report("nodmap-navigator");
  for (const time::Duration set_by : {-1h, 2h}) {
    now_.wall += set_by;
    EXPECT_TRUE(ask({{"do", "roam"}}));
    EXPECT_FALSE(answer_has("reports")) << answer_;
  }
}

// The explorer takes the repetition for a goal of somebody else, which ends the exploration.
TEST_F(RemoteControlTest, AnExplorationEndsTheRepetitionOfAGoal) {
  EXPECT_TRUE(ask({{"do", "goal"}, {"x_m", 1}, {"y_m", 1}}));
  EXPECT_TRUE(ask({{"do", "explore"}}));
  pass_ten_seconds();
  EXPECT_EQ(goal_.count(), 1);
}

TEST_F(RemoteControlTest, AReleaseByAnotherSenderEndsTheRepetition) {
  nodmap::stop_t other{};
  other.utime = 76;
  bus_.publish("STOP", other);
  handle();
  EXPECT_TRUE(ask({{"do", "stop"}}));
  bus_.publish("STOP", other);  // a copy of what was sent before our stop
  handle();
  pass(node::StopSender::kPeriod);
  EXPECT_TRUE(stop_.get()->is_stopped);
  other.utime = time::to_utime(now_.wall) + 1;
  bus_.publish("STOP", other);
  handle();
  pass(10 * node::StopSender::kPeriod);
  EXPECT_FALSE(stop_.get()->is_stopped);
}

// Sent by a host whose clock is behind ours, or at the same moment as a repetition.
TEST_F(RemoteControlTest, ARepetitionOfAStopIsNotNewerThanAReleaseSinceTheStop) {
  EXPECT_TRUE(ask({{"do", "stop"}}));
  pass(1s);
  nodmap::stop_t release{};
  release.utime = time::to_utime(now_.wall - 150ms);
  bus_.publish("STOP", release);
  handle();
  const std::int64_t count = stop_.count();
  pass(10 * node::StopSender::kPeriod);
  EXPECT_EQ(stop_.count(), count);
}

TEST_F(RemoteControlTest, ARequestToSaveMapsIsPublished) {
  EXPECT_TRUE(ask({{"do", "save_maps"}}));
  ASSERT_TRUE(save_.get());
  EXPECT_EQ(save_.get()->requested_by, "nodmap-viewer");
}

// The link was down, and the operator has walked to the robot.
TEST_F(RemoteControlTest, AnOldRequestIsRefusedUnlessItStopsTheRobot) {
  const Json goal = {{"do", "goal"}, {"x_m", 1}, {"y_m", 1}};
  for (const Json& request :
       {goal, Json({{"do", "home"}}), Json({{"do", "roam"}}), Json({{"do", "explore"}}),
        Json({{"do", "end_exploration"}}), Json({{"do", "go"}}),
        Json({{"do", "start_process"}, {"command", "navigator"}})}) {
    EXPECT_FALSE(ask(request, 5s));
    EXPECT_EQ(answer_, "Too old: not done.") << request;
  }
  EXPECT_EQ(goal_.count() + explore_.count() + stop_.count(), 0);
  EXPECT_TRUE(ask({{"do", "stop"}}, 5s));
  ASSERT_TRUE(stop_.get());
  EXPECT_TRUE(stop_.get()->is_stopped);
  EXPECT_FALSE(ask({{"do", "go"}}, RemoteControl::kMaxAge + 1us));
  EXPECT_TRUE(stop_.get()->is_stopped);
  EXPECT_TRUE(ask({{"do", "go"}}, RemoteControl::kMaxAge));
  EXPECT_FALSE(stop_.get()->is_stopped);
  EXPECT_TRUE(ask({{"do", "save_maps"}}, 5s));
  EXPECT_EQ(save_.count(), 1);
}

TEST_F(RemoteControlTest, InvalidRequestsAreRefused) {
  for (const Json& request :
       {Json({{"do", "goal"}}), Json({{"do", "goal"}, {"x_m", 1}}),
        Json({{"do", "goal"}, {"x_m", "1"}, {"y_m", 1}}),
        Json({{"do", "goal"}, {"x_m", 1e9}, {"y_m", 1}}),
        Json({{"do", "goal"}, {"x_m", 1}, {"y_m", 1}, {"tolerance_m", 0}}),
        Json({{"do", "goal"}, {"x_m", 1}, {"y_m", 1}, {"tolerance_m", 10.5}}),
        Json({{"do", "goal"}, {"x_m", 1}, {"y_m", 1}, {"tolerance_m", "1"}}), Json::object(),
        Json({{"do", 1}}), Json({{"do", "fly"}}), Json({{"do", "DRIVE"}, {"forward_mps", 1}})}) {
    EXPECT_FALSE(ask(request)) << request;
  }
  EXPECT_EQ(goal_.count() + stop_.count() + save_.count(), 0);
}

TEST_F(RemoteControlTest, WithoutAConfigurationThereIsNoControlOverProcesses) {
  for (const char* what : {"start_process", "stop_process", "restart_process", "start_recording",
                           "stop_recording", "process_output"}) {
    EXPECT_FALSE(ask({{"do", what}, {"command", "slam2d"}})) << what;
  }
}

TEST_F(RemoteControlTest, ProcessCommandsArePassedToProcessControl) {
  ProcessControl processes(
      bus_,
      procman::parse_config(R"(cmd "slam2d" { exec = "nodmap-slam2d"; host = "robot"; })").config,
      [] { return time::Moment{}; });
  RemoteControl control(
      bus_, [this] { return now_; }, &processes);
  // All else is tested with ProcessControl.
  EXPECT_EQ(control.answer({{"do", "restart_process"}, {"command", "slam2d"}}, 0s).text,
            "The deputy robot does not answer.");
  EXPECT_EQ(control.answer({{"do", "start_process"}, {"command", "nobody"}}, 0s).text,
            "There is no command \"nobody\".");
  EXPECT_EQ(control.answer({{"do", "process_output"}, {"command", "nobody"}}, 0s).text,
            "There is no command \"nobody\".");
  EXPECT_EQ(control.answer({{"do", "start_recording"}}, 0s).text,
            "The process configuration has no nodmap-logger.");
}

TEST(LogLine, IsShortWhateverAClientSends) {
  EXPECT_EQ(log_line({{"do", "stop"}}, {true, "sent"}), R"(asked for {"do":"stop"}: sent)");
  const std::string text(32'000, 'x');
  EXPECT_EQ(log_line({{"do", text}}, {false, text}).size(), 412U);  // "asked for ", ": "
}

}  // namespace remote_control_test
}  // namespace nodmap::viewer
