// SPDX-License-Identifier: BSD-3-Clause
// Tables of the processes: their STATUS, and the commands of the process manager.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"
#include "nodmap/status_t.hpp"
#include "procman/config/config.hpp"
#include "procman_lcm/deputy_info_t.hpp"

namespace nodmap::foxglove {

/// The newest STATUS of each process, in the order of their names. One message contains all,
/// because a reader may receive only the newest message of a topic.
class ProcessTable {
 public:
  /// More processes than a robot has; further names are ignored.
  static constexpr std::size_t kMaxProcesses = 64;

  struct Change {
    bool taken = false;
    bool health_changed = false;
  };
  Change update(const nodmap::status_t& status, time::Timestamp received);
  void clear() { processes_.clear(); }

  /// {timestamp, processes: [{fields of status_t, age_s}]}; age_s is how long ago a STATUS was
  /// received when the newest one of all was, on one clock: those of the senders may differ.
  [[nodiscard]] Json processes() const;

 private:
  struct Entry {
    nodmap::status_t status;
    time::Timestamp received;
  };
  std::map<std::string, Entry> processes_;
};

/// foxglove.Log with the health of a process.
[[nodiscard]] Json health_log(const nodmap::status_t& status);

/// The commands of the process manager, from the newest PM_INFO of each host.
class CommandTable {
 public:
  /// More than a robot has; further hosts are ignored.
  static constexpr std::size_t kMaxHosts = 16;
  static constexpr std::size_t kMaxCommands = 512;  ///< of one host

  /// Lists the commands of the configuration as stopped until their host reports them.
  void set_configured(const procman::Config& config) { configured_ = config.commands; }

  /// Returns false if there are too many hosts or commands.
  bool update(const procman_lcm::deputy_info_t& info, time::Timestamp received);
  /// Some message was received at this time; returns whether hosts have become silent since the
  /// last call: a host that is switched off does not say so.
  bool advance(time::Timestamp received);
  void clear() { hosts_.clear(); }

  /// {timestamp, hosts: [{..., age_s}], commands: [{command, group, host, process_name, state, pid,
  /// cpu_share, rss_bytes, end}]}; state is "running", "stopped" or "failed", `end` says how it
  /// failed; or "no deputy": its host is silent. age_s: how much earlier than the newest message
  /// that of the host was received.
  [[nodiscard]] Json commands() const;

 private:
  struct Host {
    procman_lcm::deputy_info_t info;
    time::Timestamp received;
  };
  [[nodiscard]] bool is_silent(const Host& host) const;

  std::vector<procman::Command> configured_;
  std::map<std::string, Host> hosts_;
  time::Timestamp now_;
  std::ptrdiff_t silent_hosts_ = 0;
};

}  // namespace nodmap::foxglove
