// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/procman/deputy_client.hpp"

namespace nodmap::test {

/// A deputy `rover` and a client that gives it orders. Processes that the deputy starts are marked
/// by marked(); a test fails if any of them is left at its end.
class DeputyFixture : public ::testing::Test {
 protected:
  void TearDown() override {
    deputy_.reset();
    for (const pid_t pid : processes_marked(mark_)) {
      ADD_FAILURE() << "left behind: process " << pid;
      ::kill(pid, SIGKILL);
    }
  }

  void begin(std::vector<std::string> more = {"--trust-network"}) {
    deputy_ = launch(std::move(more));
    ASSERT_TRUE(deputy_->wait_for_stderr("serving", kPatience)) << deputy_->said();
    ASSERT_TRUE(client_.wait_until([this] { return !client_.infos().empty(); }));
  }

  static std::unique_ptr<ChildProcess> launch(std::vector<std::string> more) {
    std::vector<std::string> command{NODMAP_BIN "/nodmap-deputy", "--lcm-url", kProcmanUrl, "--id",
                                     "rover"};
    command.insert(command.end(), more.begin(), more.end());
    return std::make_unique<ChildProcess>(command);
  }

  /// The exec line with a mark by which its processes are found.
  [[nodiscard]] std::string marked(const std::string& exec) const {
    return "NODMAP_TEST=" + mark_ + " " + exec;
  }

  [[nodiscard]] bool comes_to_run(const procman::CommandOrder& order) {
    client_.order({order});
    return client_.wait_until([&] { return client_.runs(order.spec.id); });
  }

  [[nodiscard]] bool disappears(std::chrono::milliseconds timeout = kPatience) {
    return client_.wait_until([this] { return processes_marked(mark_).empty(); }, timeout);
  }

  void end_cleanly() {
    deputy_->send_signal(SIGTERM);
    EXPECT_EQ(deputy_->wait_for_end(kPatience), 0) << deputy_->said();
  }

  std::string mark_ = std::to_string(::getpid()) + "-" +
                      ::testing::UnitTest::GetInstance()->current_test_info()->name();
  DeputyClient client_{"rover"};
  std::unique_ptr<ChildProcess> deputy_;
};

}  // namespace nodmap::test
