// SPDX-License-Identifier: BSD-3-Clause
#include "tests/procman/deputy_client.hpp"

#include <fstream>
#include <sstream>

#include "procman/deputy/process_table.hpp"
#include "procman/protocol/messages.hpp"

namespace nodmap::test {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

DeputyClient::DeputyClient(std::string deputy_id) : deputy_id_(std::move(deputy_id)) {
  bus_.subscribe<procman_lcm::deputy_info_t>(procman::kInfoChannel, [this](const auto& message) {
    if (message.deputy_id == deputy_id_) {
      infos_.push_back(procman::from_message(message));
    }
  });
  bus_.subscribe<procman_lcm::output_t>(procman::kOutputChannel, [this](const auto& message) {
    for (const procman::CommandOutput& part : procman::from_message(message).outputs) {
      outputs_[part.command_id] += part.text;
    }
  });
}

void DeputyClient::order(std::vector<procman::CommandOrder> commands) {
  bus_.publish(
      procman::kOrdersChannel,
      procman::to_message(procman::Orders{clock_.now(), deputy_id_, "test", std::move(commands)}));
}

bool DeputyClient::wait_until(const std::function<bool()>& condition, milliseconds timeout) {
  const auto deadline = SteadyClock::now() + timeout;
  while (!condition()) {
    if (SteadyClock::now() >= deadline) {
      return false;
    }
    bus_.handle(milliseconds(20));
  }
  return true;
}

bool DeputyClient::wait_for_infos(std::size_t count) {
  const std::size_t wanted = infos_.size() + count;
  return wait_until([this, wanted] { return infos_.size() >= wanted; });
}

procman::CommandStatus DeputyClient::status(const std::string& id) const {
  if (!infos_.empty()) {
    for (const procman::CommandStatus& status : infos_.back().commands) {
      if (status.spec.id == id) {
        return status;
      }
    }
  }
  return {};
}

procman::CommandOrder wanted(const std::string& id, const std::string& exec, int run,
                             bool force_quit) {
  procman::CommandOrder order;
  order.spec.id = id;
  order.spec.exec = exec;
  order.desired_run = run;
  order.force_quit = force_quit;
  return order;
}

std::vector<pid_t> processes_marked(const std::string& mark) {
  std::vector<pid_t> marked;
  for (const procman::ProcessRow& row : procman::read_processes()) {
    if (!row.is_dead() && procman::variable_of(row.pid, "NODMAP_TEST") == mark) {
      marked.push_back(row.pid);
    }
  }
  return marked;
}

bool is_running(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) {
    line += word + '\0';
  }
  for (const procman::ProcessRow& row : procman::read_processes()) {
    std::ifstream in("/proc/" + std::to_string(row.pid) + "/cmdline", std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();  // an iterator would throw if the process ended meanwhile
    if (!row.is_dead() && text.str() == line) {
      return true;
    }
  }
  return false;
}

}  // namespace nodmap::test
