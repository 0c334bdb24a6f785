// SPDX-License-Identifier: BSD-3-Clause
// nodmap-kurt as a process, with the emulated base on a pseudo-terminal. memq:// keeps it off the
// network.
#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <vector>

#include "drivers/kurt/test/kurt_emulator.hpp"
#include "tests/support/child_process.hpp"

namespace nodmap::kurt {
namespace program_test {

constexpr std::chrono::milliseconds kNoWait{0};

std::vector<std::string> arguments_for(const test::PtyPair& pty) {
  return {NODMAP_KURT_PROGRAM,    "--lcm-url",   "memq://", "--set",
          "device=" + pty.name(), "--log-level", "off"};
}

class KurtProgramSignals : public ::testing::TestWithParam<int> {};

TEST_P(KurtProgramSignals, StartsStationaryAndEndsWithAHardStop) {
  test::PtyPair pty;
  test::KurtEmulator base;
  test::ChildProcess process(arguments_for(pty));
  ASSERT_TRUE(test::play(pty, base, [&] { return base.commands() >= 20; }));
  EXPECT_FALSE(base.braked());
  EXPECT_EQ(base.left_cm_s(), 0);
  EXPECT_EQ(pty.baud(), 1'000'000);
  process.send_signal(GetParam());
  ASSERT_TRUE(test::play(
      pty, base, [&] { return process.wait_for_end(kNoWait).has_value() && base.braked(); }));
  EXPECT_EQ(process.wait_for_end(kNoWait), 0);
  EXPECT_EQ(base.nonsense(), 0);
}

INSTANTIATE_TEST_SUITE_P(All, KurtProgramSignals, ::testing::Values(SIGTERM, SIGHUP));

TEST(KurtProgram, EndsWithThePlugPulledOut) {
  test::PtyPair pty;
  test::KurtEmulator base;
  test::ChildProcess process(arguments_for(pty));
  ASSERT_TRUE(test::play(pty, base, [&] { return base.commands() >= 20; }));
  pty.unplug();
  process.send_signal(SIGINT);
  test::PtyPair unused;
  ASSERT_TRUE(test::play(unused, base, [&] { return process.wait_for_end(kNoWait).has_value(); }));
  EXPECT_EQ(process.wait_for_end(kNoWait), 0);
}

TEST(KurtProgram, WrongConfigurationIsExitCodeTwo) {
  test::PtyPair pty;
  test::KurtEmulator base;
  for (const char* wrong : {"device=", "limits.max_speed_mps=5.3", "guard.near_m=0.22",
                            "drive_timeout_s=0.3", "baud=38400", "no_such_key=1"}) {
    std::vector<std::string> arguments = arguments_for(pty);
    arguments.insert(arguments.end(), {"--set", wrong});
    test::ChildProcess process(arguments);
    ASSERT_TRUE(test::play(pty, base, [&] { return process.wait_for_end(kNoWait).has_value(); }));
    EXPECT_EQ(process.wait_for_end(kNoWait), 2);
  }
}

}  // namespace program_test
}  // namespace nodmap::kurt
