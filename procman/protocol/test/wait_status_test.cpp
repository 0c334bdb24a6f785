// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/wait_status.hpp"

#include <gtest/gtest.h>

#include <csignal>

namespace nodmap::procman {
namespace wait_status_test {

TEST(WaitStatus, IsDescribedAsAnExitOrASignal) {
  EXPECT_EQ(describe_end(0), "");
  EXPECT_EQ(describe_end(3 << 8), "exit 3");
  EXPECT_EQ(describe_end(SIGKILL), "killed by signal 9 (Killed)");
}

TEST(WaitStatus, AnEndIsThatOfAStopIfItCanBe) {
  EXPECT_TRUE(may_be_a_stop(0, SIGUSR1));
  EXPECT_TRUE(may_be_a_stop(SIGUSR1, SIGUSR1));
  EXPECT_TRUE(may_be_a_stop(SIGKILL, SIGUSR1));
  EXPECT_FALSE(may_be_a_stop(SIGUSR2, SIGUSR1));
  EXPECT_FALSE(may_be_a_stop(SIGUSR1 << 8, SIGUSR1)) << "an exit code";
}

}  // namespace wait_status_test
}  // namespace nodmap::procman
