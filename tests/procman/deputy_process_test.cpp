// SPDX-License-Identifier: BSD-3-Clause
// nodmap-deputy as a process: that it leaves no process behind, and that nothing stops it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>

#include "procman/deputy/process_table.hpp"
#include "tests/procman/deputy_fixture.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap {
namespace deputy_process_test {

using procman::CommandOrder;
using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;
using test::kPatience;
using test::processes_marked;
using test::wanted;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using DeputyProcess = test::DeputyFixture;

// The existing deputies crash here, or leave a child running.
TEST_F(DeputyProcess, StartedAndStoppedWithinFourMilliseconds200TimesNothingIsLeft) {
  begin();
  const std::string exec = marked("sleep 1000");
  for (int run = 1; run <= 200; ++run) {
    client_.order({wanted("a", exec, run)});
    ::usleep(static_cast<useconds_t>(run % 5) * 1000);
    client_.order({wanted("a", exec, run, true)});
    ASSERT_TRUE(client_.wait_until([&] {
      const auto status = client_.status("a");
      return status.actual_run == run && status.pid == 0 && status.wait_status != 0;
    })) << "run "
        << run << deputy_->said();
    EXPECT_EQ(client_.status("a").wait_status, SIGINT) << "run " << run;
    ASSERT_THAT(processes_marked(mark_), IsEmpty()) << "run " << run;
  }
  end_cleanly();
}

TEST_F(DeputyProcess, GivesACommandTheResourcesOfItsConfiguration) {
  const test::TemporaryDir dir;
  const std::string exec = marked("bash -c 'ulimit -d; grep Cpus_allowed_list /proc/self/status'");
  std::ofstream(dir.path() / "robot.pmd")
      << R"(cmd "a" { exec = ")" << exec << R"("; host = "rover";
      #nodmap: memory_mb = 512; cpus = "0";
  })";
  begin({dir.path() / "robot.pmd"});
  client_.order({wanted("a", exec, 1)});
  EXPECT_TRUE(client_.wait_until([&] {
    return client_.output("a").find("Cpus_allowed_list:\t0\r") != std::string::npos;
  })) << client_.output("a");
  EXPECT_THAT(client_.output("a"), HasSubstr("500000\r"));  // of 1024 bytes
  end_cleanly();
}

// Gives this process and its children a capability, as the deputy's service does.
bool take_ambient_right(unsigned capability) {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, 2> rights{};
  if (::syscall(SYS_capget, &header, rights.data()) != 0) {
    return false;
  }
  rights[0].inheritable |= 1U << capability;
  return ::syscall(SYS_capset, &header, rights.data()) == 0 &&
         ::prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_RAISE, capability, 0, 0) == 0;
}

TEST_F(DeputyProcess, ItsCapabilityIsNotInheritedByItsCommands) {
  if (!take_ambient_right(CAP_SYS_NICE)) {
    GTEST_SKIP() << "needs the right to change other processes' priority (CAP_SYS_NICE)";
  }
  begin();
  ::prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  const std::string exec = marked("bash -c 'grep CapAmb /proc/self/status'");
  client_.order({wanted("a", exec, 1)});
  EXPECT_TRUE(client_.wait_until([&] {
    return client_.output("a").find("CapAmb:\t0000000000000000\r") != std::string::npos;
  })) << client_.output("a");
  end_cleanly();
}

TEST_F(DeputyProcess, RestartedWithinFourMilliseconds200TimesThereIsOneProcess) {
  begin();
  const std::string exec = marked("sleep 1000");
  ASSERT_TRUE(comes_to_run(wanted("a", exec, 1)));
  for (int run = 2; run <= 201; ++run) {
    client_.order({wanted("a", exec, run)});
    ::usleep(static_cast<useconds_t>(run % 5) * 1000);
    // A sheriff repeats its orders; the order after the end of the old run starts the new one.
    ASSERT_TRUE(client_.wait_until([&] {
      const auto status = client_.status("a");
      if (status.pid == 0) {
        client_.order({wanted("a", exec, run)});
      }
      return status.actual_run == run && status.pid != 0;
    })) << "run "
        << run;
    ASSERT_LE(processes_marked(mark_).size(), 1U) << "run " << run;
  }
  end_cleanly();
}

TEST_F(DeputyProcess, ATreeThatIgnoresTheSignalIsKilledAfterItsGraceTime) {
  begin();
  // The tree ignores the signal and has grandchildren: one in its session, one in a session of its
  // own, and one whose parent has ended.
  const std::string script =
      "bash -c 'trap \"\" INT TERM HUP; sleep 1001 & setsid sleep 1002 & "
      "(setsid bash -c \"sleep 1003 & sleep 1004\" &) ; while true; do sleep 0.1; done'";
  CommandOrder order = wanted("tree", marked(script), 1);
  order.spec.stop_time_allowed_s = 1.0;
  ASSERT_TRUE(comes_to_run(order));
  ASSERT_TRUE(client_.wait_until([this] { return processes_marked(mark_).size() >= 5; }));
  order.force_quit = true;
  const auto stopped = SteadyClock::now();
  client_.order({order});  // once: the deputy needs no repetition
  ASSERT_TRUE(client_.wait_until([this] { return client_.status("tree").wait_status != 0; }));
  EXPECT_THAT(processes_marked(mark_), IsEmpty()) << "the end is reported when no process is left";
  EXPECT_EQ(client_.status("tree").wait_status, SIGKILL);
  EXPECT_GE(SteadyClock::now() - stopped, milliseconds(1000)) << "not before its grace time";
  end_cleanly();
}

// Many times, because a process that is left may be between fork, setsid and exec when its parent
// ends.
TEST_F(DeputyProcess, ProcessesThatACommandLeavesAreEndedWithIt) {
  begin();
  for (int run = 1; run <= 100; ++run) {
    client_.order({wanted("a", marked("bash -c 'setsid sleep 1000 & exit 3'"), run)});
    ASSERT_TRUE(client_.wait_until([&] {
      return client_.status("a").actual_run == run && client_.status("a").wait_status == 3 << 8;
    }));
    ASSERT_THAT(processes_marked(mark_), IsEmpty()) << "run " << run;
  }
  end_cleanly();
}

TEST_F(DeputyProcess, AKilledChildIsReportedAndRespawned) {
  begin();
  CommandOrder order = wanted("a", marked("sleep 1000"), 1);
  order.spec.auto_respawn = true;
  ASSERT_TRUE(comes_to_run(order));
  const pid_t first = client_.status("a").pid;
  ::kill(first, SIGKILL);
  ASSERT_TRUE(client_.wait_until(
      [&] { return client_.status("a").pid != 0 && client_.status("a").pid != first; }));
  EXPECT_EQ(client_.status("a").actual_run, 1);
  EXPECT_TRUE(std::any_of(client_.infos().begin(), client_.infos().end(), [](const auto& info) {
    return !info.commands.empty() && info.commands[0].wait_status == SIGKILL;
  }));
  EXPECT_TRUE(client_.wait_until([this] { return client_.output("a") == "Killed\n"; }));
  end_cleanly();
}

// A command that fails again and again would fill the journal with its old failures.
TEST_F(DeputyProcess, LogsTheOutputOfEachFailedRunOnce) {
  begin();
  constexpr int kRuns = 3;
  for (int run = 1; run <= kRuns; ++run) {
    client_.order({wanted("a", marked("bash -c 'echo no device; exit 3'"), run)});
    ASSERT_TRUE(client_.wait_until([&] {
      return client_.status("a").actual_run == run && client_.status("a").wait_status == 3 << 8;
    }));
  }
  end_cleanly();
  const std::string& log = deputy_->said();
  int count = 0;
  for (std::size_t at = 0; (at = log.find("a: no device", at)) != std::string::npos; ++at) {
    ++count;
  }
  EXPECT_EQ(count, kRuns) << log;
}

TEST_F(DeputyProcess, EndingCleanlyItLeavesNoProcess) {
  begin();
  // One of them hides everything by which it could be found: parent, session and environment.
  const std::string hidden = std::to_string(100'000 + ::getpid());
  ASSERT_TRUE(comes_to_run(wanted("a",
                                  marked("bash -c '(setsid sleep 1000 &); (env -i setsid sleep " +
                                         hidden + " &) ; sleep 1000; true'"),
                                  1)));
  ASSERT_TRUE(client_.wait_until([&] {
    return processes_marked(mark_).size() >= 3 && test::is_running({"sleep", hidden});
  }));
  end_cleanly();
  EXPECT_THAT(processes_marked(mark_), IsEmpty());
  EXPECT_FALSE(test::is_running({"sleep", hidden}));
}

TEST_F(DeputyProcess, ASecondSignalEndsItWithoutWaitingForGraceTimes) {
  begin();
  CommandOrder order =
      wanted("a", marked("bash -c 'trap \"\" INT; echo ready; sleep 1000; sleep 1000'"), 1);
  order.spec.stop_time_allowed_s = 3600.0;
  ASSERT_TRUE(comes_to_run(order));
  ASSERT_TRUE(client_.wait_until([this] { return client_.output("a") == "ready\r\n"; }));
  deputy_->send_signal(SIGINT);
  EXPECT_TRUE(deputy_->wait_for_stderr("a: signal 2", kPatience)) << "the command is asked to stop";
  EXPECT_TRUE(client_.wait_for_infos(1));
  EXPECT_TRUE(client_.runs("a")) << "its grace time is an hour";
  deputy_->send_signal(SIGINT);
  EXPECT_EQ(deputy_->wait_for_end(kPatience), 0);
}

// After SIGKILL the deputy's commands end at once. Their own processes get SIGHUP, and those that
// survive it end when the deputy is started again.
TEST_F(DeputyProcess, KilledItsCommandsEndAndTheRestEndsWhenItIsStartedAgain) {
  begin();
  ASSERT_TRUE(comes_to_run(
      wanted("a", marked("bash -c 'trap \"\" HUP; setsid sleep 1000 & sleep 1000; true'"), 1)));
  ASSERT_TRUE(client_.wait_until([this] { return processes_marked(mark_).size() >= 3; }));
  const pid_t first = client_.status("a").pid;
  deputy_->send_signal(SIGKILL);
  ASSERT_EQ(deputy_->wait_for_end(kPatience), 128 + SIGKILL);
  EXPECT_TRUE(client_.wait_until([first] {
    const auto row = procman::read_process(first);
    return !row || row->is_dead();
  })) << "PR_SET_PDEATHSIG";
  begin();
  EXPECT_TRUE(disappears());
  end_cleanly();
}

TEST_F(DeputyProcess, RunsOnlyCommandsOfItsConfiguration) {
  const test::TemporaryDir dir;
  const std::string file = dir.path() / "robot.pmd";
  const std::string good = marked("sleep 1000");
  std::ofstream(file) << "cmd \"good\" { exec = \"" << good << "\"; host = \"rover\"; }\n"
                      << "cmd \"far\" { exec = \"" << good << " 1\"; host = \"other\"; }\n";
  begin({file});
  client_.order({wanted("good", good, 1), wanted("bad", good + " ; rm", 1),
                 wanted("far", good + " 1", 1), wanted("again", good, 1)});
  ASSERT_TRUE(client_.wait_until([this] {
    return client_.runs("good") && client_.status("bad").wait_status != 0 &&
           client_.output("far") != "" && client_.output("again") != "";
  }));
  EXPECT_EQ(client_.status("bad").wait_status, 127 << 8);
  EXPECT_THAT(client_.output("bad"), HasSubstr("refused"));
  EXPECT_THAT(client_.output("far"), HasSubstr("refused"));
  EXPECT_THAT(client_.output("again"), HasSubstr("refused")) << "the exec line of another name";
  EXPECT_TRUE(client_.wait_until([this] { return processes_marked(mark_).size() == 1; }));
  end_cleanly();
}

TEST_F(DeputyProcess, RefusesToStartWithoutAConfigurationOrTwice) {
  EXPECT_EQ(launch({})->wait_for_end(kPatience), 2)
      << "neither a configuration nor --trust-network";
  begin();
  const auto second = launch({"--trust-network"});
  EXPECT_EQ(second->wait_for_end(kPatience), 1) << "anybody can send a PM_INFO in its name: it "
                                                   "must be started again; "
                                                << second->said();
  EXPECT_THAT(second->said(), HasSubstr("a deputy rover is already running"));
  end_cleanly();
}

TEST_F(DeputyProcess, ReportsCommandsThatCannotBeRun) {
  begin();
  client_.order({wanted("none", "/no/such/program", 1), wanted("empty", "A=1", 1)});
  ASSERT_TRUE(client_.wait_until([this] {
    return client_.status("none").wait_status != 0 && client_.status("empty").wait_status != 0;
  }));
  EXPECT_EQ(client_.status("none").wait_status, 127 << 8);
  EXPECT_EQ(client_.status("empty").wait_status, 127 << 8);
  EXPECT_TRUE(client_.wait_until(
      [this] { return client_.output("none").find("No such file") != std::string::npos; }));
  end_cleanly();
}

}  // namespace deputy_process_test
}  // namespace nodmap
