// SPDX-License-Identifier: BSD-3-Clause
// nodmap-goal as a process, with an emulated navigator. Run by tests/support/private_network.sh.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/live_bus.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/path_t.hpp"
#include "tests/support/child_process.hpp"

namespace nodmap {
namespace goal_process_test {

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";

// What an emulated navigator does with a goal.
enum class Does : std::uint8_t {
  kArrive,      // from the third GOAL on
  kFindNoPath,  // and says so
  kIgnore,      // it drives to another goal
  kHalt,        // for one reason and then for another; then a signal ends the program
  kRefuse,  // it halts, because the goal is outside the geofence, and says that there is no path
};

// Halts for one reason until the program has had five more reports of it, then for another; ends
// the program when that was said.
void halt(nodmap::navigation_t& navigation, const test::ChildProcess& program, int& num_reports) {
  const auto was_said = [&program](const char* text) {
    return program.said().find(text) != std::string::npos;
  };
  num_reports += was_said("Stopped by the page.") ? 1 : 0;
  navigation.behaviour = nodmap::navigation_t::HALT;
  navigation.reason = num_reports <= 5 ? "Stopped by the page." : "The servo is stalled.";
  if (was_said("The servo is stalled.")) {
    program.send_signal(SIGINT);
  }
}

// Emulates a navigator until the program ends; returns its exit code. `last_goal`: the last that it
// got.
std::optional<int> navigate(Does does, test::ChildProcess& program,
                            nodmap::goal_t* last_goal = nullptr) {
  bus::LiveBus bus(kUrl);
  nodmap::navigation_t navigation{};
  nodmap::path_t path{};
  const bool finds_path = does != Does::kFindNoPath && does != Does::kRefuse;
  path.state = finds_path ? nodmap::path_t::PLANNED : nodmap::path_t::NO_PATH;
  navigation.reason = finds_path ? "" : "A wall is in the way.";
  bus.subscribe<nodmap::goal_t>("GOAL", [&](const nodmap::goal_t& goal) {
    if (last_goal != nullptr) {
      *last_goal = goal;
    }
    navigation.goal_utime = does == Does::kIgnore ? 1 : goal.utime;
    path.goal_utime = navigation.goal_utime;
    const bool has_arrived = does == Does::kArrive && goal.goal_seq >= 2;
    navigation.behaviour = has_arrived             ? nodmap::navigation_t::ARRIVED
                           : does == Does::kRefuse ? nodmap::navigation_t::HALT
                                                   : nodmap::navigation_t::STEER;
  });
  int num_reports = 0;
  const auto end = std::chrono::steady_clock::now() + test::kPatience;
  std::optional<int> code;
  while (!code && std::chrono::steady_clock::now() < end) {
    code = program.wait_for_end(std::chrono::milliseconds(50));
    (void)bus.handle(std::chrono::milliseconds(0));
    if (does == Does::kHalt && !code) {
      halt(navigation, program, num_reports);
    }
    bus.publish("NAVIGATION", navigation);
    bus.publish("PATH", path);
  }
  return code;
}

TEST(GoalProcess, ANavigatorThatDrivesToTheGoalIsWaitedFor) {
  test::ChildProcess program({NODMAP_GOAL_PROGRAM, "3", "1", "--wait", "2", "--lcm-url", kUrl});
  EXPECT_EQ(navigate(Does::kArrive, program), 0) << program.said();
}

TEST(GoalProcess, HomeIsTheOriginOfTheMapAndComesLast) {
  for (const std::vector<std::string>& waypoints :
       {std::vector<std::string>{}, std::vector<std::string>{"3", "1"}}) {
    std::vector<std::string> command{NODMAP_GOAL_PROGRAM, "--home", "--wait", "2",
                                     "--lcm-url",         kUrl};
    command.insert(command.begin() + 1, waypoints.begin(), waypoints.end());
    test::ChildProcess program(command);
    nodmap::goal_t goal{};
    goal.position_m[0] = goal.position_m[1] = 9.0;
    EXPECT_EQ(navigate(Does::kArrive, program, &goal), 0) << program.said();
    EXPECT_EQ(goal.position_m[0], 0.0);
    EXPECT_EQ(goal.position_m[1], 0.0);
    EXPECT_FALSE(goal.has_heading) << "there may be a wall behind it";
  }
}

TEST(GoalProcess, ANavigatorThatDoesNotTakeTheGoalIsNotWaitedForForEver) {
  test::ChildProcess program({NODMAP_GOAL_PROGRAM, "3", "1", "--wait", "1", "--lcm-url", kUrl});
  EXPECT_EQ(navigate(Does::kIgnore, program), 1);
  EXPECT_TRUE(program.wait_for_stderr("no nodmap-navigator", test::kPatience));
}

TEST(GoalProcess, AMissedWaypointIsReportedWithTheNavigatorsReason) {
  test::ChildProcess program({"sh", "-c", R"(exec "$0" "$@" >&2)", NODMAP_GOAL_PROGRAM, "3", "1",
                              "--patience", "1", "--lcm-url", kUrl});
  EXPECT_EQ(navigate(Does::kFindNoPath, program), 1);
  EXPECT_TRUE(program.wait_for_stderr("missed; the navigator says: A wall", test::kPatience));
}

TEST(GoalProcess, AWaypointOutsideTheGeofenceIsMissed) {
  test::ChildProcess program(
      {NODMAP_GOAL_PROGRAM, "3", "1", "--patrol", "--patience", "1", "--lcm-url", kUrl});
  EXPECT_EQ(navigate(Does::kRefuse, program), 1) << program.said();
}

TEST(GoalProcess, SaysOnceWhyTheRobotMayNotDriveAndAtTheEndThatItStillWill) {
  test::ChildProcess program(
      {"sh", "-c", R"(exec "$0" "$@" >&2)", NODMAP_GOAL_PROGRAM, "3", "-1.5", "--lcm-url", kUrl});
  EXPECT_EQ(navigate(Does::kHalt, program), 1);
  EXPECT_EQ(program.said(),
            "the robot may not drive; the navigator says: Stopped by the page.\n"
            "the robot may not drive; the navigator says: The servo is stalled.\n"
            "nodmap-goal: ended early; the robot still drives to 3 -1.5 and stays there "
            "(nodmap-stop stops it)\n");
}

}  // namespace goal_process_test
}  // namespace nodmap
