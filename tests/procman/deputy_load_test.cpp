// SPDX-License-Identifier: BSD-3-Clause
// nodmap-deputy under load: many processes, floods of output, messages larger than a datagram.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "procman/protocol/messages.hpp"
#include "tests/procman/deputy_fixture.hpp"

namespace nodmap {
namespace deputy_load_test {

using procman::CommandOrder;
using SteadyClock = std::chrono::steady_clock;
using test::processes_marked;
using test::wanted;
using ::testing::HasSubstr;

using DeputyLoad = test::DeputyFixture;

constexpr std::size_t kDatagramBytes = 64 * 1024;

TEST_F(DeputyLoad, AFloodOfOutputIsLimitedAndDelaysNoOtherCommand) {
  begin();
  const auto begun = SteadyClock::now();
  client_.order(
      {wanted("flood", marked("yes 0123456789012345678901234567890123456789"), 1),
       wanted("tick", marked("bash -c 'while true; do echo tick; sleep 0.05; done'"), 1)});
  ASSERT_TRUE(client_.wait_until([this] { return client_.runs("tick") && client_.runs("flood"); }));
  ASSERT_TRUE(client_.wait_until([this] {
    return client_.output("flood").size() > 192U * 1024U &&
           client_.output("flood").find("bytes of output dropped") != std::string::npos;
  })) << "more than the burst is published, the rest is counted";
  EXPECT_TRUE(client_.wait_for_infos(2)) << "the deputy still sends INFO";
  EXPECT_TRUE(client_.wait_until([this] { return client_.output("tick").size() > 20U * 6U; }))
      << "the output of the other command is published";
  EXPECT_THAT(client_.output("tick"), ::testing::Not(HasSubstr("dropped")));
  // The deputy's limit is by the same clock. What was dropped is reported in a line each second.
  const double elapsed_s = std::chrono::duration<double>(SteadyClock::now() - begun).count();
  EXPECT_LE(static_cast<double>(client_.output("flood").size()),
            128.0 * 1024.0 + elapsed_s * (64.0 * 1024.0 + 80.0));
  client_.order({wanted("flood", "x", 1, true), wanted("tick", "x", 1, true)});
  EXPECT_TRUE(disappears());
  end_cleanly();
}

// The number of bytes that were dropped, according to the command's output.
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

TEST_F(DeputyLoad, TheDroppedBytesOfAFloodThatEndsAreCountedExactly) {
  begin();
  constexpr std::int64_t kWritten = 30'000'000;
  const auto begun = SteadyClock::now();
  client_.order({wanted("flood",
                        marked("bash -c 'head -c " + std::to_string(kWritten) +
                               " /dev/zero | tr [:cntrl:] x; exit 7'"),
                        1)});
  ASSERT_TRUE(client_.wait_until([this] { return client_.status("flood").wait_status == 7 << 8; }))
      << "it is slowed down, but not blocked for ever";
  const double took_s = std::chrono::duration<double>(SteadyClock::now() - begun).count();
  const auto received = [this] {
    const std::string& output = client_.output("flood");
    // The report of dropped bytes does not contain this letter.
    return static_cast<std::int64_t>(std::count(output.begin(), output.end(), 'x'));
  };
  EXPECT_TRUE(client_.wait_until([&] {
    return received() + bytes_dropped(client_.output("flood")) == kWritten;
  })) << received()
      << " received, " << bytes_dropped(client_.output("flood")) << " dropped";
  std::printf("a flood of %.0f MB: read at %.1f MB/s, %.2f MB published at %.0f KiB/s\n",
              static_cast<double>(kWritten) * 1e-6, static_cast<double>(kWritten) * 1e-6 / took_s,
              static_cast<double>(received()) * 1e-6,
              static_cast<double>(received()) / 1024.0 / took_s);
  end_cleanly();
}

// The protocol has no parts: a message larger than a datagram is one message of several LCM
// fragments, which every existing sheriff and deputy can receive.
TEST_F(DeputyLoad, OrdersAndInfoLargerThanADatagramArriveComplete) {
  begin();
  std::vector<CommandOrder> orders;
  for (int i = 0; i < 300; ++i) {
    orders.push_back(wanted(std::string(100, 'n') + std::to_string(i),
                            marked("sleep 1000 " + std::string(100, '0')), 0, true));
  }
  const procman::Orders message{{}, "rover", "test", orders};
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

TEST_F(DeputyLoad, AHundredProcessesRunAndAreStoppedTogether) {
  begin();
  std::vector<CommandOrder> orders;
  for (int i = 0; i < 100; ++i) {
    orders.push_back(wanted("command-" + std::to_string(i), marked("sleep 1000"), 1));
  }
  client_.order(orders);
  ASSERT_TRUE(client_.wait_until([this] {
    return processes_marked(mark_).size() == 100 && client_.infos().back().commands.size() == 100;
  }));
  for (CommandOrder& order : orders) {
    EXPECT_TRUE(client_.wait_until([&] { return client_.runs(order.spec.id); })) << order.spec.id;
    order.force_quit = true;
  }
  client_.order(orders);
  EXPECT_TRUE(disappears());
  end_cleanly();
}

}  // namespace deputy_load_test
}  // namespace nodmap
