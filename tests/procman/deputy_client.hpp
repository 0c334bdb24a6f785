// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "procman/protocol/values.hpp"
#include "tests/support/child_process.hpp"

namespace nodmap::test {

inline constexpr const char* kProcmanUrl = "udpm://239.255.76.67:7692?ttl=0&recv_buf_size=2000000";

/// Acts as a sheriff: sends orders to one deputy and keeps its messages.
class DeputyClient {
 public:
  explicit DeputyClient(std::string deputy_id);

  void order(std::vector<procman::CommandOrder> commands);

  /// Handles messages until the condition holds. False if it does not hold in time.
  bool wait_until(const std::function<bool()>& condition,
                  std::chrono::milliseconds timeout = kPatience);
  /// Handles messages until `count` more INFOs have come: the deputy sends one a second, and one at
  /// each change.
  bool wait_for_infos(std::size_t count);

  /// The status of a command in the newest INFO; a default one if it is unknown.
  [[nodiscard]] procman::CommandStatus status(const std::string& id) const;
  [[nodiscard]] bool runs(const std::string& id) const { return status(id).pid != 0; }
  [[nodiscard]] const std::vector<procman::DeputyInfo>& infos() const { return infos_; }
  /// The whole output of a command.
  [[nodiscard]] std::string output(const std::string& id) const {
    const auto found = outputs_.find(id);
    return found == outputs_.end() ? "" : found->second;
  }
  [[nodiscard]] bus::LiveBus& bus() { return bus_; }

 private:
  std::string deputy_id_;
  time::SystemClock clock_;
  bus::LiveBus bus_{kProcmanUrl};
  std::vector<procman::DeputyInfo> infos_;
  std::map<std::string, std::string> outputs_;
};

/// An order for a command.
[[nodiscard]] procman::CommandOrder wanted(const std::string& id, const std::string& exec, int run,
                                           bool force_quit = false);

/// The running processes whose environment contains NODMAP_TEST=`mark`.
[[nodiscard]] std::vector<pid_t> processes_marked(const std::string& mark);

/// Whether a process with exactly this command line is running.
[[nodiscard]] bool is_running(const std::vector<std::string>& words);

}  // namespace nodmap::test
