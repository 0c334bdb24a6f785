// SPDX-License-Identifier: BSD-3-Clause
// nodmap-stop as a process, with an emulated base driver. Run by tests/support/private_network.sh.
#include <gtest/gtest.h>

#include <chrono>

#include "common/bus/live_bus.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/stop_t.hpp"
#include "tests/support/child_process.hpp"

namespace nodmap {
namespace stop_process_test {

constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";

struct BaseDriver {
  bool obeys = true;              // or it is stopped again at once
  int num_failed = 0;             // STATUS messages in which it is FAILED
  int released_while_failed = 0;  // releases received meanwhile
};

// Releases the base driver. Returns the exit code.
int release(BaseDriver& driver, test::ChildProcess& program) {
  bus::LiveBus bus(kUrl);
  bool is_stopped = true;
  bus.subscribe<nodmap::stop_t>("STOP", [&](const nodmap::stop_t& message) {
    is_stopped &= message.is_stopped != 0 || !driver.obeys;
    driver.released_while_failed += message.is_stopped == 0 && driver.num_failed > 0 ? 1 : 0;
  });
  std::optional<int> code;
  while (!(code = program.wait_for_end(std::chrono::milliseconds(100)))) {
    (void)bus.handle(std::chrono::milliseconds(0));
    nodmap::status_t status{};
    status.process_name = "nodmap-kurt";
    if (driver.num_failed > 0) {
      --driver.num_failed;
      status.health = nodmap::status_t::FAILED;
      status.health_reason = "is the base switched on?";
    }
    bus.publish("STATUS", status);
    if (is_stopped) {
      nodmap::stop_t stop{};
      stop.is_stopped = 1;
      stop.requested_by = "nodmap-kurt, for a bumper";
      bus.publish("STOP", stop);
    }
  }
  return *code;
}

// Stops the base driver, which loses the first messages. Returns the exit code.
int stop(int num_lost, test::ChildProcess& program) {
  bus::LiveBus bus(kUrl);
  int num_stops = 0;
  bus.subscribe<nodmap::stop_t>(
      "STOP", [&](const nodmap::stop_t& message) { num_stops += message.is_stopped; });
  std::optional<int> code;
  while (!(code = program.wait_for_end(std::chrono::milliseconds(100)))) {
    (void)bus.handle(std::chrono::milliseconds(0));
    if (num_stops > num_lost) {
      nodmap::stop_t confirmation{};
      confirmation.is_stopped = 1;
      confirmation.requested_by = "nodmap-kurt, for nodmap-stop";
      bus.publish("STOP", confirmation);
    }
  }
  return *code;
}

TEST(StopProcess, AStopIsRepeatedUntilTheBaseDriverConfirmsIt) {
  test::ChildProcess program({NODMAP_STOP_PROGRAM, "--wait", "60", "--lcm-url", kUrl});
  EXPECT_EQ(stop(10, program), 0) << program.said();
}

TEST(StopProcess, AStopThatNobodyConfirmsFails) {
  test::ChildProcess program({NODMAP_STOP_PROGRAM, "--wait", "0", "--lcm-url", kUrl});
  EXPECT_EQ(stop(1000, program), 1);
  EXPECT_TRUE(program.wait_for_stderr("no nodmap-kurt has confirmed it", test::kPatience));
}

TEST(StopProcess, AReleaseThatTheBaseDriverObeysSucceeds) {
  test::ChildProcess program({NODMAP_STOP_PROGRAM, "--go", "--lcm-url", kUrl});
  BaseDriver driver;
  EXPECT_EQ(release(driver, program), 0) << program.said();
}

TEST(StopProcess, AReleaseAfterWhichTheRobotIsStillStoppedFails) {
  test::ChildProcess program({NODMAP_STOP_PROGRAM, "--go", "--lcm-url", kUrl});
  BaseDriver driver{.obeys = false};
  EXPECT_EQ(release(driver, program), 1);
  EXPECT_TRUE(
      program.wait_for_stderr("still stopped, by nodmap-kurt, for a bumper", test::kPatience));
}

// The base driver would stop the robot again when its base is there.
TEST(StopProcess, AReleaseWaitsForTheBase) {
  test::ChildProcess program({NODMAP_STOP_PROGRAM, "--go", "--lcm-url", kUrl});
  BaseDriver driver{.num_failed = 20};
  EXPECT_EQ(release(driver, program), 0) << program.said();
  EXPECT_EQ(driver.num_failed, 0);
  EXPECT_EQ(driver.released_while_failed, 0);
}

TEST(StopProcess, WithoutTheBaseNothingIsReleased) {
  test::ChildProcess program({NODMAP_STOP_PROGRAM, "--go", "--wait", "1", "--lcm-url", kUrl});
  BaseDriver driver{.num_failed = 1000};
  EXPECT_EQ(release(driver, program), 1);
  EXPECT_EQ(driver.released_while_failed, 0);
  EXPECT_TRUE(
      program.wait_for_stderr("nodmap-kurt is FAILED: is the base switched on?", test::kPatience));
}

}  // namespace stop_process_test
}  // namespace nodmap
