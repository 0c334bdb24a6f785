// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/serial_workers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <latch>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/data_dir.hpp"

namespace nodmap::node {
namespace serial_workers_test {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

TEST(SerialWorkers, AreTheUnboundWorkersOfTheKernel) {
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

TEST(SerialWorkers, AContainerHasNone) {
  const test::TemporaryDir dir;
  write(dir.path() / "2/comm", "bash\n");
  write(dir.path() / "2/task/2/children", "40 ");
  write(dir.path() / "40/comm", "kworker/u8:0\n");
  EXPECT_TRUE(serial_workers(dir.path()).empty());
  EXPECT_TRUE(serial_workers(dir.path() / "nothing").empty());
}

// Three threads of this program in the place of the kernel's workers. All programs of the machine
// share the real ones, and whatever runs beside this test may raise them or end them.
class SerialWorkersTest : public ::testing::Test {
 protected:
  static constexpr std::size_t kWorkers = 3;

  SerialWorkersTest() {
    for (pid_t& id : ids_) {
      threads_.emplace_back([this, &id] {
        id = ::gettid();
        started_.count_down();
        end_.wait();
      });
    }
    started_.wait();
    write(proc() / "2/comm", "kthreadd\n");
    std::string children;
    for (const pid_t id : ids_) {
      children += std::to_string(id) + " ";
      write(proc() / std::to_string(id) / "comm", "kworker/u8:0\n");
    }
    write(proc() / "2/task/2/children", children);
  }

  ~SerialWorkersTest() override { end_.count_down(); }

  [[nodiscard]] const fs::path& proc() const { return dir_.path(); }

  [[nodiscard]] std::array<int, kWorkers> policies() const {
    std::array<int, kWorkers> result{};
    std::ranges::transform(ids_, result.begin(), ::sched_getscheduler);
    return result;
  }

  // The kernel's answer, asked without the code under test.
  [[nodiscard]] bool is_permitted() const {
    const sched_param real_time{1};
    const sched_param ordinary{};
    return ::sched_setscheduler(ids_[0], SCHED_FIFO, &real_time) == 0 &&
           ::sched_setscheduler(ids_[0], SCHED_OTHER, &ordinary) == 0;
  }

  const std::array<int, kWorkers> all_ordinary_{SCHED_OTHER, SCHED_OTHER, SCHED_OTHER};
  const std::array<int, kWorkers> all_raised_{SCHED_FIFO, SCHED_FIFO, SCHED_FIFO};

 private:
  const test::TemporaryDir dir_;
  std::array<pid_t, kWorkers> ids_{};
  std::latch started_{kWorkers};
  std::latch end_{1};
  std::vector<std::jthread> threads_;
};

TEST_F(SerialWorkersTest, MayBeRaisedIfTheKernelPermitsIt) {
  EXPECT_EQ(may_raise_serial_workers(proc()), is_permitted());
  EXPECT_EQ(policies(), all_ordinary_);
  EXPECT_FALSE(may_raise_serial_workers(proc() / "nothing"));
}

TEST_F(SerialWorkersTest, AreRaisedAndGivenTheirOrdinaryPriorityBack) {
  const bool permitted = is_permitted();
  {
    SerialWorkers workers(proc());
    EXPECT_EQ(workers.raise(), permitted);
    EXPECT_EQ(workers.raise(), permitted) << "a second time";
    EXPECT_EQ(policies(), permitted ? all_raised_ : all_ordinary_);
  }
  EXPECT_EQ(policies(), all_ordinary_);
}

TEST_F(SerialWorkersTest, ThoseThatSomebodyElseRaisedStayRaised) {
  SerialWorkers others(proc());
  if (!others.raise()) {
    GTEST_SKIP() << "needs the right to raise a thread's priority (CAP_SYS_NICE)";
  }
  EXPECT_TRUE(may_raise_serial_workers(proc()));
  {
    SerialWorkers workers(proc());
    EXPECT_TRUE(workers.raise());
  }
  EXPECT_EQ(policies(), all_raised_);
}

}  // namespace serial_workers_test
}  // namespace nodmap::node
