// SPDX-License-Identifier: BSD-3-Clause
// Compares with a recording of the existing deputy and sheriff.
#include "procman/protocol/messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap::procman {
namespace messages_test {

// Whether the bytes can be decoded to our values and encoded to the same bytes.
template <class Message>
bool comes_back(std::span<const std::byte> bytes) {
  Message message{};
  if (!bus::decode_into(message, bytes)) {
    return false;
  }
  std::vector<std::byte> again;
  bus::encode_into(again, to_message(from_message(message)));
  return std::equal(again.begin(), again.end(), bytes.begin(), bytes.end());
}

// Whether the bytes truncated at any position are refused.
template <class Message>
void expect_damage_refused(std::span<const std::byte> bytes) {
  Message message{};
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(bus::decode_into(message, bytes.first(size))) << size;
  }
}

TEST(ProcmanMessages, MessagesOfTheExistingToolsAreEncodedAgainToTheSameBytes) {
  NODMAP_REQUIRE_DATA(file, "procman/golden.lcmlog");
  bus::LogReader log(file);
  std::map<std::string, int> counts;
  while (const bus::LogEvent* event = log.next()) {
    const std::string& channel = event->channel;
    ++counts[channel];
    if (channel == kDiscoverChannel) {
      EXPECT_TRUE(comes_back<procman_lcm::discovery_t>(event->data)) << event->event_number;
    } else if (channel == kInfoChannel) {
      EXPECT_TRUE(comes_back<procman_lcm::deputy_info_t>(event->data)) << event->event_number;
      expect_damage_refused<procman_lcm::deputy_info_t>(event->data);
    } else if (channel == kOrdersChannel) {
      EXPECT_TRUE(comes_back<procman_lcm::orders_t>(event->data)) << event->event_number;
      expect_damage_refused<procman_lcm::orders_t>(event->data);
    } else if (channel == kOutputChannel) {
      EXPECT_TRUE(comes_back<procman_lcm::output_t>(event->data)) << event->event_number;
      expect_damage_refused<procman_lcm::output_t>(event->data);
    }
  }
  EXPECT_EQ(counts[kDiscoverChannel], 4);
  EXPECT_EQ(counts[kInfoChannel], 26);
  EXPECT_EQ(counts[kOrdersChannel], 15);
  EXPECT_EQ(counts[kOutputChannel], 8);
}

TEST(ProcmanMessages, RunsRoundTripAndInvalidOnesAreLeftOut) {
  const Runs runs{time::Timestamp(5us), "h", {{"a", 17, 90s, 2}, {"b", 18, 1us, 0}}};
  nodmap::runs_t message = to_message(runs);
  EXPECT_EQ(from_message(message), runs);
  message.pid = {0, 1};
  message.uptime_us[1] = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(from_message(message).runs, (std::vector<CommandRun>{{"b", 1, time::kLimit, 0}}));
  message.uptime_us[1] = -1;
  EXPECT_TRUE(from_message(message).runs.empty());
  message.uptime_us[1] = 1;
  message.num_restarts[1] = -1;
  EXPECT_TRUE(from_message(message).runs.empty());
}

}  // namespace messages_test
}  // namespace nodmap::procman
