// SPDX-License-Identifier: BSD-3-Clause
// nodmap-deputy with much to do: many processes, floods of output, messages of more than a
// datagram.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <string>

#include "procman/deputy/process_table.hpp"
#include "procman/protocol/messages.hpp"
#include "tests/procman/deputy_fixture.hpp"

namespace nodmap {
namespace {

using procman::CommandOrder;
using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;
using test::processes_marked;
using test::wanted;
using ::testing::HasSubstr;

using DeputyLoad = test::DeputyFixture;

constexpr std::size_t kDatagramBytes = 64 * 1024;

TEST_F(DeputyLoad, AFloodIsLimitedCountedAndBlocksNobody) {
  begin();
  client_.order(
      {wanted("flood", marked("yes 0123456789012345678901234567890123456789"), 1),
       wanted("tick", marked("bash -c 'while true; do echo tick; sleep 0.05; done'"), 1)});
  ASSERT_TRUE(client_.wait_until([this] { return client_.runs("tick") && client_.runs("flood"); }));
  const std::size_t infos_before = client_.infos().size();
  client_.listen_for(milliseconds(3000));
  EXPECT_GE(client_.infos().size(), infos_before + 2) << "still speaks each second";
  // 128 KiB at first, then 64 KiB/s, for the three seconds and the moment before them.
  EXPECT_LT(client_.output("flood").size(), (128U + 5U * 64U) * 1024U);
  EXPECT_GT(client_.output("flood").size(), 128U * 1024U);
  EXPECT_THAT(client_.output("flood"), HasSubstr("bytes of output dropped"));
  EXPECT_GT(client_.output("tick").size(), 20U * 6U) << "the quiet one is heard";
  EXPECT_THAT(client_.output("tick"), ::testing::Not(HasSubstr("dropped")));
  client_.order({wanted("flood", "x", 1, true), wanted("tick", "x", 1, true)});
  EXPECT_TRUE(is_gone());
  end_cleanly();
}

/// How many bytes a command's output says were dropped.
std::int64_t bytes_dropped(const std::string& output) {
  static const std::string kBegin = "[nodmap-deputy: ";
  static const std::string kEnd = " bytes of output dropped]";
  std::int64_t sum = 0;
  for (std::size_t end = output.find(kEnd); end != std::string::npos;
       end = output.find(kEnd, end + 1)) {
    const std::size_t begin = output.rfind(kBegin, end);
    EXPECT_NE(begin, std::string::npos);
    sum += std::stoll(output.substr(begin + kBegin.size(), end));
  }
  return sum;
}

TEST_F(DeputyLoad, AFloodThatEndsIsCountedToTheByte) {
  begin();
  constexpr std::int64_t kWritten = 30'000'000;
  const auto begun = SteadyClock::now();
  client_.order({wanted("flood",
                        marked("bash -c 'head -c " + std::to_string(kWritten) +
                               " /dev/zero | tr [:cntrl:] x; exit 7'"),
                        1)});
  ASSERT_TRUE(client_.wait_until([this] { return client_.status("flood").wait_status == 7 << 8; },
                                 milliseconds(120'000)))
      << "is slowed, and not blocked for ever";
  const double took_s = std::chrono::duration<double>(SteadyClock::now() - begun).count();
  const auto heard = [this] {
    const std::string& output = client_.output("flood");
    // The complaint has no such letter.
    return static_cast<std::int64_t>(std::count(output.begin(), output.end(), 'x'));
  };
  EXPECT_TRUE(client_.wait_until([&] {
    return heard() + bytes_dropped(client_.output("flood")) == kWritten;
  })) << heard()
      << " heard, " << bytes_dropped(client_.output("flood")) << " dropped";
  std::printf("a flood of %.0f MB: read at %.1f MB/s, %.2f MB published at %.0f KiB/s\n",
              static_cast<double>(kWritten) * 1e-6, static_cast<double>(kWritten) * 1e-6 / took_s,
              static_cast<double>(heard()) * 1e-6, static_cast<double>(heard()) / 1024.0 / took_s);
  end_cleanly();
}

// The protocol knows no parts: what is larger than a datagram goes as one message of several LCM
// fragments, which every existing sheriff and deputy puts together.
TEST_F(DeputyLoad, OrdersAndInfoOfMoreThanADatagramArriveWhole) {
  begin();
  std::vector<CommandOrder> orders;
  for (int i = 0; i < 300; ++i) {
    orders.push_back(wanted(std::string(100, 'n') + std::to_string(i),
                            marked("sleep 1000 " + std::string(100, '0')), 0, true));
  }
  const procman::Orders message{0, "rover", "test", orders};
  ASSERT_GT(procman::to_message(message).getEncodedSize(), static_cast<int>(kDatagramBytes));
  client_.order(orders);
  ASSERT_TRUE(client_.wait_until([&] { return client_.infos().back().commands.size() == 300; }));
  const procman::DeputyInfo& info = client_.infos().back();
  EXPECT_GT(procman::to_message(info).getEncodedSize(), static_cast<int>(kDatagramBytes));
  for (const CommandOrder& order : orders) {
    EXPECT_TRUE(std::any_of(info.commands.begin(), info.commands.end(),
                            [&](const auto& status) { return status.spec == order.spec; }));
  }
  orders.back().desired_run = 1;
  orders.back().force_quit = false;
  client_.order(orders);
  EXPECT_TRUE(client_.wait_until([&] { return client_.runs(orders.back().spec.id); }));
  end_cleanly();
}

TEST_F(DeputyLoad, AHundredProcessesTakeLittleOfACore) {
  begin();
  std::vector<CommandOrder> orders;
  for (int i = 0; i < 100; ++i) {
    orders.push_back(wanted("command-" + std::to_string(i), marked("sleep 1000"), 1));
  }
  client_.order(orders);
  ASSERT_TRUE(client_.wait_until([this] { return processes_marked(mark_).size() == 100; }));
  client_.listen_for(milliseconds(1500));  // the work of starting them is done
  pid_t deputy = 0;
  for (const auto& row : procman::read_processes()) {
    if (row.pid == client_.status("command-0").pid) {
      deputy = row.parent;
    }
  }
  const auto before = procman::read_process(deputy);
  const auto begun = SteadyClock::now();
  for (int i = 0; i < 10; ++i) {
    client_.order(orders);
    client_.listen_for(milliseconds(1000));
  }
  const auto after = procman::read_process(deputy);
  ASSERT_TRUE(before && after);
  const double busy_s = static_cast<double>(after->cpu_ticks - before->cpu_ticks) /
                        static_cast<double>(::sysconf(_SC_CLK_TCK));
  const double share = busy_s / std::chrono::duration<double>(SteadyClock::now() - begun).count();
  std::printf("deputy with 100 processes: %.2f %% of a core\n", 100.0 * share);
  EXPECT_LE(share, 0.02);
  EXPECT_EQ(client_.infos().back().commands.size(), 100U);
  for (CommandOrder& order : orders) {
    order.force_quit = true;
  }
  client_.order(orders);
  EXPECT_TRUE(is_gone());
  end_cleanly();
}

}  // namespace
}  // namespace nodmap
