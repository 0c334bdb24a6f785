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

// Releases a base driver, which either obeys or is stopped again at once. Returns the exit code.
int release(bool obeys, test::ChildProcess& program) {
  bus::LiveBus bus(kUrl);
  bool is_stopped = true;
  bus.subscribe<nodmap::stop_t>("STOP", [&](const nodmap::stop_t& message) {
    is_stopped &= message.is_stopped != 0 || !obeys;
  });
  std::optional<int> code;
  while (!(code = program.wait_for_end(std::chrono::milliseconds(100)))) {
    (void)bus.handle(std::chrono::milliseconds(0));
    nodmap::status_t status{};
    status.process_name = "nodmap-kurt";
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

TEST(StopProcess, AReleaseThatTheBaseDriverObeysSucceeds) {
  test::ChildProcess program({NODMAP_STOP_PROGRAM, "--go", "--lcm-url", kUrl});
  EXPECT_EQ(release(true, program), 0) << program.said();
}

TEST(StopProcess, AReleaseAfterWhichTheRobotIsStillStoppedFails) {
  test::ChildProcess program({NODMAP_STOP_PROGRAM, "--go", "--lcm-url", kUrl});
  EXPECT_EQ(release(false, program), 1);
  EXPECT_TRUE(
      program.wait_for_stderr("still stopped, by nodmap-kurt, for a bumper", test::kPatience));
}

}  // namespace stop_process_test
}  // namespace nodmap
