// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <poll.h>

#include <boost/core/noncopyable.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/time.hpp"
#include "procman/deputy/child_process.hpp"
#include "procman/deputy/process_table.hpp"

namespace nodmap::procman {

/// The running commands of a deputy as processes, each with all that descends from it. Makes this
/// process the one that orphans are given to, so that whatever a command leaves behind is found:
/// by its parents, by its session, and by a variable in its environment.
class Children : boost::noncopyable {
 public:
  /// How long a killed tree may take to vanish before its command counts as ended anyway.
  static constexpr time::Duration kMaxSweepTime = 2s;
  static constexpr time::Duration kSweepPeriod = 10ms;
  /// A terminal is read so often, and so much of it at once: what writes more waits for a moment.
  static constexpr time::Duration kReadPeriod = 10ms;
  static constexpr std::size_t kMaxReadBytes = std::size_t{64} * 1024;

  /// Prepends `own_folder` to the PATH of what is started.
  Children(const std::string& deputy_id, const std::string& own_folder);
  /// However the deputy ends: nothing stays behind.
  ~Children() { kill_everything(); }

  /// Starts an exec line for a command that does not run. Throws std::runtime_error.
  [[nodiscard]] pid_t start(const std::string& id, const std::string& exec,
                            const Resources& resources);

  /// Sends a signal to a command and all that descends from it.
  void signal(const std::string& id, int signal);

  struct Ended {
    std::string id;
    int wait_status = 0;
  };
  /// Collects what has ended. A command is reported when nothing of its tree is left: what outlives
  /// its first process is killed.
  [[nodiscard]] std::vector<Ended> reap(time::SteadyTime now);

  using OutputHandler = std::function<void(const std::string& id, std::string_view text)>;
  /// Reads what has been written, within the limits.
  void read_output(const OutputHandler& handler, time::SteadyTime now);

  /// What to wait on for output, now.
  void add_to_poll(std::vector<pollfd>& waiting, time::SteadyTime now) const;
  /// When to come back even if nothing is to be read.
  [[nodiscard]] std::optional<time::SteadyTime> due(time::SteadyTime now) const;

  /// Kills what belongs to a run that is over, should something have slipped away from it. To be
  /// called once in a while.
  void kill_strays() const;

  /// Kills every process below this one, and waits for their end (bounded).
  static void kill_everything();

  /// Kills what a deputy of this name that was itself killed has left behind. How many.
  int kill_leftovers();

  [[nodiscard]] std::optional<pid_t> pid_of(const std::string& id) const;

 private:
  struct Run {
    pid_t pid = 0;
    std::string mark;
    Descriptor terminal;
    bool hung_up = false;
    time::SteadyTime next_read{};
    std::optional<int> wait_status;  // the first process has ended
    time::SteadyTime ended{};
    time::SteadyTime next_sweep{};  // when its tree is looked at again
    bool looked_at = false;         // and found empty, but for what was not clear
  };

  void collect_exits(time::SteadyTime now);
  [[nodiscard]] bool is_first_process(pid_t pid) const;
  [[nodiscard]] bool is_orphan(const ProcessRow& row) const;
  [[nodiscard]] bool is_gone(Run& run) const;
  [[nodiscard]] std::vector<pid_t> tree(const Run& run, std::span<const ProcessRow> table) const;
  void kill_tree(const Run& run) const;
  static bool read_some(const std::string& id, Run& run, const OutputHandler& handler);

  std::string mark_prefix_;  // of this name
  std::string own_mark_;     // of this process
  std::string search_path_;
  std::map<std::string, Run> runs_;
  OutputHandler last_words_;
  std::int64_t num_started_ = 0;
};

}  // namespace nodmap::procman
