// SPDX-License-Identifier: BSD-3-Clause
// nodmap-goal as a process, with an emulated navigator. Run by tests/support/private_network.sh.
#include <gtest/gtest.h>

#include <chrono>
#include <optional>

#include "common/bus/live_bus.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "tests/support/child_process.hpp"

namespace nodmap {
namespace goal_process_test {

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";

// Emulates a navigator until the program ends; returns its exit code. `obeys`: it takes the goal,
// and arrives when it is sent for the third time; else it drives to another goal.
std::optional<int> navigate(bool obeys, test::ChildProcess& program) {
  bus::LiveBus bus(kUrl);
  nodmap::navigation_t navigation{};
  bus.subscribe<nodmap::goal_t>("GOAL", [&](const nodmap::goal_t& goal) {
    navigation.goal_utime = obeys ? goal.utime : 1;
    const bool has_arrived = obeys && goal.goal_seq == 2;
    navigation.behaviour =
        has_arrived ? nodmap::navigation_t::ARRIVED : nodmap::navigation_t::STEER;
  });
  const auto end = std::chrono::steady_clock::now() + test::kPatience;
  std::optional<int> code;
  while (!code && std::chrono::steady_clock::now() < end) {
    code = program.wait_for_end(std::chrono::milliseconds(50));
    (void)bus.handle(std::chrono::milliseconds(0));
    bus.publish("NAVIGATION", navigation);
  }
  return code;
}

TEST(GoalProcess, ANavigatorThatDrivesToTheGoalIsWaitedFor) {
  test::ChildProcess program({NODMAP_GOAL_PROGRAM, "3", "1", "--wait", "2", "--lcm-url", kUrl});
  EXPECT_EQ(navigate(true, program), 0) << program.said();
}

TEST(GoalProcess, ANavigatorThatDoesNotTakeTheGoalIsNotWaitedForForEver) {
  test::ChildProcess program({NODMAP_GOAL_PROGRAM, "3", "1", "--wait", "1", "--lcm-url", kUrl});
  EXPECT_EQ(navigate(false, program), 1);
  EXPECT_TRUE(program.wait_for_stderr("no nodmap-navigator", test::kPatience));
}

}  // namespace goal_process_test
}  // namespace nodmap
