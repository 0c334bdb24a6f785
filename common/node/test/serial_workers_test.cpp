// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/serial_workers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <fstream>
#include <map>

#include "tests/support/data_dir.hpp"

namespace nodmap::node {
namespace serial_workers_test {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

std::map<pid_t, int> policies() {
  std::map<pid_t, int> result;
  for (const pid_t pid : serial_workers()) {
    result[pid] = ::sched_getscheduler(pid);
  }
  return result;
}

TEST(SerialWorkersTest, AreTheUnboundWorkersOfTheKernel) {
  const test::TemporaryDir dir;
  write(dir.path() / "2/comm", "kthreadd\n");
  write(dir.path() / "2/task/2/children", "3 40 41 42 ");
  write(dir.path() / "3/comm", "kworker/0:0-events\n");
  write(dir.path() / "40/comm", "kworker/u8:0-events_unbound\n");
  write(dir.path() / "42/comm", "kworker/u9:1\n");
  // 41 has ended meanwhile; 50 is a program that calls itself so.
  write(dir.path() / "50/comm", "kworker/u8:7\n");
  EXPECT_THAT(serial_workers(dir.path()), ::testing::ElementsAre(40, 42));
}

TEST(SerialWorkersTest, AContainerHasNone) {
  const test::TemporaryDir dir;
  write(dir.path() / "2/comm", "bash\n");
  write(dir.path() / "2/task/2/children", "40 ");
  write(dir.path() / "40/comm", "kworker/u8:0\n");
  EXPECT_TRUE(serial_workers(dir.path()).empty());
  EXPECT_TRUE(serial_workers(dir.path() / "nothing").empty());
}

// The kernel may have created or ended workers meanwhile.
void expect_unchanged(const std::map<pid_t, int>& before) {
  for (const auto& [pid, policy] : policies()) {
    EXPECT_TRUE(!before.contains(pid) || policy == before.at(pid) || policy < 0) << pid;
  }
}

// A single test, because all tests that run at the same time share the kernel's workers.
TEST(SerialWorkersTest, AreRaisedAndGivenTheirOrdinaryPriorityBack) {
  const std::map<pid_t, int> before = policies();
  const bool may_raise = may_raise_serial_workers();
  expect_unchanged(before);
  if (!may_raise) {
    SerialWorkers workers;
    EXPECT_FALSE(workers.raise());
    GTEST_SKIP() << "needs the right to change the kernel's threads (CAP_SYS_NICE)";
  }
  {
    SerialWorkers workers;
    EXPECT_TRUE(workers.raise());
    EXPECT_TRUE(workers.raise());
    for (const auto& [pid, policy] : policies()) {
      EXPECT_TRUE(policy != SCHED_OTHER || !before.contains(pid)) << pid;
    }
  }
  expect_unchanged(before);
}

}  // namespace serial_workers_test
}  // namespace nodmap::node
