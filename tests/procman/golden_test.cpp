// SPDX-License-Identifier: BSD-3-Clause
// Sends the recorded orders of the existing sheriff to our deputy. Its INFO and OUTPUT must be the
// recorded ones of the existing deputy, except for pids, times and loads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <sstream>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "procman/protocol/messages.hpp"
#include "tests/procman/deputy_client.hpp"
#include "tests/support/data_dir.hpp"

namespace nodmap {
namespace golden_test {

using procman::CommandStatus;
using procman::DeputyInfo;

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

// Whether `seen` is the end, by itself, of the run that `before` shows. A short run may have ended
// before any INFO told that it runs, so that `before` is left out.
bool ends_by_itself(const Seen& before, const Seen& seen) {
  return before.runs && !seen.runs && before.run == seen.run && before.spec == seen.spec &&
         WIFEXITED(seen.wait_status);
}

// How a command ended. The loop of `echoer` is stopped by SIGINT; but bash survives it if it
// arrives while the `sleep` for which it waits ends by itself, and the deputy then kills it.
int end_of(const CommandStatus& status) {
  const bool was_killed =
      WIFSIGNALED(status.wait_status) && WTERMSIG(status.wait_status) == SIGKILL;
  return status.spec.id == "echoer" && was_killed ? SIGINT : status.wait_status;
}

// The states through which each command went, without repetitions.
std::map<std::string, std::vector<Seen>> histories(const std::vector<DeputyInfo>& infos) {
  std::map<std::string, std::vector<Seen>> all;
  for (const DeputyInfo& info : infos) {
    for (const CommandStatus& status : info.commands) {
      const Seen seen{status.spec, status.pid != 0, status.actual_run, end_of(status)};
      std::vector<Seen>& history = all[status.spec.id];
      if (!history.empty() && ends_by_itself(history.back(), seen)) {
        history.pop_back();
      }
      if (history.empty() || history.back() != seen) {
        history.push_back(seen);
      }
    }
  }
  return all;
}

// Whether a command has gone through at least the `wanted` states. One that has ended by itself
// has run.
bool has_gone_through(const std::vector<Seen>& seen, const std::vector<Seen>& wanted) {
  return seen.size() > wanted.size() ||
         (seen.size() == wanted.size() &&
          (seen.back() == wanted.back() || ends_by_itself(wanted.back(), seen.back())));
}

// Whether every command has gone through at least these states.
bool has_reached(const std::vector<DeputyInfo>& infos, const std::vector<DeputyInfo>& wanted) {
  const auto seen = histories(infos);
  const auto expected = histories(wanted);
  return std::all_of(expected.begin(), expected.end(), [&seen](const auto& item) {
    const auto found = seen.find(item.first);
    return found != seen.end() && has_gone_through(found->second, item.second);
  });
}

// The lines of a command's output without repetitions: how often a loop prints its line depends on
// the time. How `echoer` ends does not count, as in end_of().
std::vector<std::string> lines_of(const std::string& id, const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    if (id == "echoer" && line == "Killed") {
      line = "Interrupt";
    }
    if (lines.empty() || lines.back() != line) {
      lines.push_back(line);
    }
  }
  return lines;
}

using Outputs = std::map<std::string, std::string>;  // a command's output, by its id

struct Recording {
  struct Sent {
    time::Timestamp received{};
    procman::Orders orders;
    std::size_t num_infos = 0;  // number of INFOs recorded before
    Outputs outputs;            // what had been printed before
  };
  std::vector<Sent> orders;
  std::vector<DeputyInfo> infos;
  Outputs outputs;
};

Recording read(const std::filesystem::path& file) {
  Recording recording;
  bus::LogReader log(file);
  while (const bus::LogEvent* event = log.next()) {
    if (event->channel == procman::kOrdersChannel) {
      procman_lcm::orders_t message{};
      EXPECT_TRUE(bus::decode_into(message, event->data));
      recording.orders.push_back({time::from_utime(event->log_utime_us),
                                  procman::from_message(message), recording.infos.size(),
                                  recording.outputs});
    } else if (event->channel == procman::kInfoChannel) {
      procman_lcm::deputy_info_t message{};
      EXPECT_TRUE(bus::decode_into(message, event->data));
      recording.infos.push_back(procman::from_message(message));
    } else if (event->channel == procman::kOutputChannel) {
      procman_lcm::output_t message{};
      EXPECT_TRUE(bus::decode_into(message, event->data));
      for (const procman::CommandOutput& part : procman::from_message(message).outputs) {
        recording.outputs[part.command_id] += part.text;
      }
    }
  }
  return recording;
}

// Whether every command has printed at least as many lines as these.
bool has_printed(const test::DeputyClient& client, const Outputs& outputs) {
  return std::all_of(outputs.begin(), outputs.end(), [&client](const auto& item) {
    const auto& [id, text] = item;
    return lines_of(id, client.output(id)).size() >= lines_of(id, text).size();
  });
}

TEST(Golden, OurDeputyGoesThroughTheRecordedStates) {
  NODMAP_REQUIRE_DATA(file, "procman/golden.lcmlog");
  NODMAP_REQUIRE_DATA(config, "procman/golden.pmd");
  const Recording recording = read(file);
  ASSERT_EQ(recording.orders.size(), 15U);
  test::DeputyClient client("rover");
  test::ChildProcess deputy(
      {NODMAP_BIN "/nodmap-deputy", "--lcm-url", test::kProcmanUrl, config.string()});
  ASSERT_TRUE(deputy.wait_for_stderr("serving", test::kPatience)) << deputy.said();
  ASSERT_TRUE(client.wait_until([&] { return !client.infos().empty(); }));
  // Each order follows the previous one after the recorded time, and not before the deputy is in
  // the state in which the existing one was by then, and its commands have printed as much.
  time::Timestamp before = recording.orders.front().received;
  auto sent = SteadyClock::now();
  for (const auto& [received, orders, num_infos, outputs] : recording.orders) {
    const auto due = sent + (received - before);
    const std::vector<DeputyInfo> infos_before(
        recording.infos.begin(), recording.infos.begin() + static_cast<std::ptrdiff_t>(num_infos));
    ASSERT_TRUE(client.wait_until([&, &outputs = outputs] {
      // `stubborn` is that from its first pause on.
      return SteadyClock::now() >= due && has_reached(client.infos(), infos_before) &&
             has_printed(client, outputs) &&
             (!client.runs("stubborn") || test::is_running({"sleep", "0.2"}));
    })) << testing::PrintToString(histories(client.infos()));
    client.order(orders.commands);
    sent = SteadyClock::now();
    before = received;
  }
  EXPECT_TRUE(client.wait_until([&] { return has_reached(client.infos(), recording.infos); }));
  EXPECT_EQ(histories(client.infos()), histories(recording.infos));
  for (const auto& [id, text] : recording.outputs) {
    EXPECT_TRUE(client.wait_until([&, id = id, text = text] {
      return lines_of(id, client.output(id)) == lines_of(id, text);
    })) << id
        << ": " << client.output(id);
  }
  deputy.send_signal(SIGTERM);
  EXPECT_EQ(deputy.wait_for_end(test::kPatience), 0);
}

}  // namespace golden_test
}  // namespace nodmap
