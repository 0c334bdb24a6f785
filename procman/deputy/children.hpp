// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <poll.h>

#include <boost/core/noncopyable.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/time.hpp"
#include "procman/deputy/child_process.hpp"
#include "procman/deputy/process_table.hpp"

namespace nodmap::procman {

/// The running commands of a deputy, each with its process tree. A process belongs to a command by
/// its parents, its session, or a variable in its environment. Orphans become children of the
/// deputy, which makes itself the subreaper.
class Children : boost::noncopyable {
 public:
  /// How long a killed tree may take to disappear before its command counts as ended anyway. On a
  /// busy machine a process that has been killed may not get to its end for seconds.
  static constexpr time::Duration kMaxKillTime = 10s;
  static constexpr time::Duration kTreeCheckPeriod = 10ms;
  /// From each terminal at most `kMaxReadBytes` are read per `kReadPeriod`; a command that writes
  /// more has to wait.
  static constexpr time::Duration kReadPeriod = 10ms;
  static constexpr std::size_t kMaxReadBytes = std::size_t{64} * 1024;

  using OutputHandler = std::function<void(const std::string& id, std::string_view text)>;

  /// Prepends `own_folder` to the PATH of started programs. `on_output` receives what the commands
  /// write.
  Children(const std::string& deputy_id, const std::string& own_folder, OutputHandler on_output);
  /// Kills everything, so that no process outlives the deputy.
  ~Children() { kill_everything(); }

  /// Starts a command that is not running. Throws std::runtime_error.
  [[nodiscard]] pid_t start(const std::string& id, const std::string& exec,
                            const Resources& resources);

  /// Sends a signal to all processes of a command's tree.
  void signal(const std::string& id, int signal);

  struct Ended {
    std::string id;
    int wait_status = 0;
  };
  /// The commands that have ended since the last call, after their last output was read. When the
  /// first process of a command ends, the rest of its tree is killed; the command is reported when
  /// none of its processes is left.
  [[nodiscard]] std::vector<Ended> reap(time::SteadyTime now);

  /// Reads the output of all commands, within the limits.
  void read_output(time::SteadyTime now);

  /// Adds the descriptors to wait on for output.
  void add_to_poll(std::vector<pollfd>& waiting, time::SteadyTime now) const;
  /// When reap() or read_output() must be called next, even without new output.
  [[nodiscard]] std::optional<time::SteadyTime> due(time::SteadyTime now) const;

  /// Kills processes that escaped when their run ended. Call it from time to time.
  void kill_strays() const;

  /// Kills all descendants of this process and waits for their end, for a limited time.
  static void kill_everything();

  /// Kills the processes that a killed deputy of this name left behind; returns their number.
  int kill_leftovers();

 private:
  struct Run {
    pid_t pid = 0;
    std::string mark;
    formats::FileDescriptor terminal;
    bool has_hung_up = false;
    time::SteadyTime next_read{};
    std::optional<int> wait_status;  // set when the first process has ended
    time::SteadyTime ended{};
    time::SteadyTime next_check{};  // when its tree is checked again
    bool was_looked_at =
        false;  // checked once and found empty, except for processes of unknown owner
  };

  void collect_exits(time::SteadyTime now);
  [[nodiscard]] bool is_first_process(pid_t pid) const;
  [[nodiscard]] bool is_orphan(const ProcessRow& row) const;
  [[nodiscard]] bool check_gone(Run& run) const;
  [[nodiscard]] bool end_tree(Run& run, time::SteadyTime now) const;
  [[nodiscard]] std::vector<pid_t> tree(const Run& run, std::span<const ProcessRow> table) const;
  void kill_tree(const Run& run) const;
  bool read_some(const std::string& id, Run& run) const;

  OutputHandler on_output_;
  std::string mark_prefix_;  // of all deputies of this name
  std::string own_mark_;     // of this process
  std::string search_path_;
  std::map<std::string, Run> runs_;
  std::int64_t num_started_ = 0;
};

}  // namespace nodmap::procman
