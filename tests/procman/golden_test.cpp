// SPDX-License-Identifier: BSD-3-Clause
// The recorded orders of the existing sheriff, at their recorded pace, drive our deputy through the
// states of the existing one: its INFO and OUTPUT are the recorded ones but for pids, times, loads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "procman/protocol/messages.hpp"
#include "tests/procman/deputy_client.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap {
namespace {

using procman::CommandStatus;
using procman::DeputyInfo;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

struct Seen {
  procman::CommandSpec spec;
  bool runs = false;
  int run = 0;
  int wait_status = 0;
  bool operator==(const Seen&) const = default;
};

void PrintTo(const Seen& seen, std::ostream* out) {
  *out << seen.spec.id << (seen.runs ? " runs" : " does not run") << ", run " << seen.run
       << ", status " << seen.wait_status;
}

/// The states each command went through, without repetitions.
std::map<std::string, std::vector<Seen>> histories(const std::vector<DeputyInfo>& infos) {
  std::map<std::string, std::vector<Seen>> all;
  for (const DeputyInfo& info : infos) {
    for (const CommandStatus& status : info.commands) {
      const Seen seen{status.spec, status.pid != 0, status.actual_run, status.wait_status};
      std::vector<Seen>& history = all[status.spec.id];
      if (history.empty() || history.back() != seen) {
        history.push_back(seen);
      }
    }
  }
  return all;
}

struct Recording {
  std::vector<std::pair<std::int64_t, procman::Orders>> orders;
  std::vector<DeputyInfo> infos;
  std::map<std::string, std::string> outputs;
};

Recording read(const std::filesystem::path& file) {
  Recording recording;
  bus::LogReader log(file);
  while (const bus::LogEvent* event = log.next()) {
    if (event->channel == procman::kOrdersChannel) {
      procman_lcm::orders_t message{};
      EXPECT_TRUE(bus::decode_into(message, event->data));
      recording.orders.emplace_back(event->log_utime_us, procman::from_message(message));
    } else if (event->channel == procman::kInfoChannel) {
      procman_lcm::deputy_info_t message{};
      EXPECT_TRUE(bus::decode_into(message, event->data));
      recording.infos.push_back(procman::from_message(message));
    } else if (event->channel == procman::kOutputChannel) {
      procman_lcm::output_t message{};
      EXPECT_TRUE(bus::decode_into(message, event->data));
      for (const procman::Said& said : procman::from_message(message).said) {
        recording.outputs[said.command_id] += said.text;
      }
    }
  }
  return recording;
}

TEST(Golden, OurDeputyGoesThroughTheRecordedStates) {
  NODMAP_REQUIRE_DATA(file, "procman/golden.lcmlog");
  NODMAP_REQUIRE_DATA(config, "procman/golden.pmd");
  const Recording recording = read(file);
  ASSERT_EQ(recording.orders.size(), 15U);
  test::DeputyClient client("rover");
  test::ChildProcess deputy(
      {NODMAP_BIN "/nodmap-deputy", "--lcm-url", test::kProcmanUrl, "--config", config.string()});
  ASSERT_TRUE(deputy.wait_for_stderr("serving", test::kPatience)) << deputy.said();
  ASSERT_TRUE(client.wait_until([&] { return !client.infos().empty(); }));
  const auto begun = SteadyClock::now();
  for (const auto& [utime_us, orders] : recording.orders) {
    const auto due = begun + microseconds(utime_us - recording.orders.front().first);
    while (SteadyClock::now() < due) {
      client.bus().handle(std::max(
          milliseconds(1), std::chrono::duration_cast<milliseconds>(due - SteadyClock::now())));
    }
    client.order(orders.commands);
  }
  client.listen_for(milliseconds(1500));
  EXPECT_EQ(histories(client.infos()), histories(recording.infos));
  for (const auto& [id, text] : recording.outputs) {
    EXPECT_EQ(client.output(id), text) << id;
  }
  deputy.send_signal(SIGTERM);
  EXPECT_EQ(deputy.wait_for_end(test::kPatience), 0);
}

}  // namespace
}  // namespace nodmap
