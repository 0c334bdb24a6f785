// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/children.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "procman/deputy/child_process.hpp"

namespace nodmap::procman {
namespace {

constexpr const char* kMarkVariable = "NODMAP_DEPUTY_CHILD";
// A tree that forks while it is killed is killed again, at most this often.
constexpr int kMaxRounds = 10;
constexpr time::Duration kEndRound = 5ms;
constexpr time::Duration kMaxEndTime = 2s;

std::optional<std::string> own_variable(const std::string& name) {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): the environment is never changed
  const char* value = std::getenv(name.c_str());
  return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

// The environment of a command: the deputy's, then the assignments of its exec line, then the
// mark.
std::vector<std::string> environment_of(const ExecLine& exec, const std::string& search_path,
                                        const std::string& mark) {
  std::map<std::string, std::string> variables;
  for (char** at = ::environ; *at != nullptr; ++at) {
    const std::string_view text(*at);
    const std::size_t assign = text.find('=');
    if (assign != std::string_view::npos) {
      variables[std::string(text.substr(0, assign))] = text.substr(assign + 1);
    }
  }
  variables["PATH"] = search_path;
  for (const auto& [name, value] : exec.environment) {
    variables[name] = value;
  }
  variables[kMarkVariable] = mark;
  std::vector<std::string> all;
  all.reserve(variables.size());
  for (const auto& [name, value] : variables) {
    all.push_back(name);
    all.back().append("=").append(value);
  }
  return all;
}

std::string path_of(const ExecLine& exec, const std::string& otherwise) {
  std::string path = otherwise;
  for (const auto& [name, value] : exec.environment) {
    path = name == "PATH" ? value : path;
  }
  return path;
}

std::string mark_of_process(const std::string& prefix, pid_t pid, std::uint64_t start_ticks) {
  return prefix + std::to_string(pid) + ":" + std::to_string(start_ticks) + ":";
}

}  // namespace

Children::Children(const std::string& deputy_id, const std::string& own_folder,
                   OutputHandler on_output)
    : on_output_(std::move(on_output)),
      mark_prefix_(deputy_id + ":"),
      search_path_(own_folder + ":" + own_variable("PATH").value_or("/usr/bin:/bin")) {
  const std::optional<ProcessRow> self = read_process(::getpid());
  own_mark_ = mark_of_process(mark_prefix_, ::getpid(), self ? self->start_ticks : 0);
  if (::prctl(PR_SET_CHILD_SUBREAPER, 1) != 0) {
    throw std::runtime_error(
        "this system does not reparent orphans to the deputy (PR_SET_CHILD_SUBREAPER)");
  }
}

pid_t Children::start(const std::string& id, const std::string& exec_line,
                      const Resources& resources) {
  const ExecLine exec = parse_exec_line(exec_line, own_variable);
  if (exec.arguments.empty()) {
    throw std::runtime_error("the exec line has no program: " + exec_line);
  }
  Run run;
  run.mark = own_mark_ + std::to_string(++num_started_);
  Child child = start_child({exec.arguments, environment_of(exec, search_path_, run.mark),
                             path_of(exec, search_path_), resources});
  run.pid = child.pid;
  run.terminal = std::move(child.terminal);
  runs_.insert_or_assign(id, std::move(run));
  return runs_.at(id).pid;
}

bool Children::is_first_process(pid_t pid) const {
  return std::ranges::any_of(runs_, [pid](const auto& item) { return item.second.pid == pid; });
}

bool Children::is_orphan(const ProcessRow& row) const {
  return row.parent == ::getpid() && !is_first_process(row.pid) && !row.is_dead();
}

std::vector<pid_t> Children::tree(const Run& run, std::span<const ProcessRow> table) const {
  return tree_of(table, [&](const ProcessRow& row) {
    if (row.pid == run.pid || row.session == run.pid) {
      return true;
    }
    // An orphan that has left its session still has its initial environment.
    return is_orphan(row) && variable_of(row.pid, kMarkVariable) == run.mark;
  });
}

void Children::signal(const std::string& id, int signal) {
  const auto found = runs_.find(id);
  if (found == runs_.end()) {
    return;
  }
  if (signal == SIGKILL) {
    kill_tree(found->second);
    return;
  }
  // The first process is found without the table; its pid is not reused before we have waited for
  // it.
  const std::vector<ProcessRow> table = read_processes();
  if (!found->second.wait_status) {
    ::kill(found->second.pid, signal);
  }
  for (const pid_t pid : tree(found->second, table)) {
    if (pid != found->second.pid) {
      ::kill(pid, signal);
    }
  }
}

void Children::kill_tree(const Run& run) const {
  std::set<pid_t> struck;
  bool is_new = true;
  for (int round = 0; is_new && round < kMaxRounds; ++round) {
    is_new = false;
    for (const pid_t pid : tree(run, read_processes())) {
      is_new |= struck.insert(pid).second;
      ::kill(pid, SIGKILL);
    }
  }
}

void Children::collect_exits(time::SteadyTime now) {
  int status = 0;
  pid_t pid = 0;
  while ((pid = ::waitpid(-1, &status, WNOHANG)) > 0) {
    for (auto& [id, run] : runs_) {
      if (run.pid == pid && !run.wait_status) {
        run.wait_status = status;
        run.ended = now;
      }
    }
  }
}

// Returns whether no process of a tree is left. Checks twice, because one look can miss a process:
// one that forks and exits while the table is read, or one in the middle of exec, whose
// environment cannot be read for a moment.
bool Children::check_gone(Run& run) const {
  if (!tree(run, read_processes()).empty()) {
    return false;
  }
  const std::vector<ProcessRow> table = read_processes();
  const bool is_unclear = std::ranges::any_of(
      table, [this](const ProcessRow& row) { return is_orphan(row) && !has_environment(row.pid); });
  const bool was_looked_at = std::exchange(run.was_looked_at, true);
  return tree(run, table).empty() && (!is_unclear || was_looked_at);
}

// Kills what is left of a tree. Returns whether nothing is left, or this has taken too long.
bool Children::end_tree(Run& run, time::SteadyTime now) const {
  if (check_gone(run) || now - run.ended >= kMaxKillTime) {
    return true;
  }
  kill_tree(run);
  run.next_check = now + kTreeCheckPeriod;
  return false;
}

std::vector<Children::Ended> Children::reap(time::SteadyTime now) {
  collect_exits(now);
  std::vector<Ended> all;
  for (auto at = runs_.begin(); at != runs_.end();) {
    auto& [id, run] = *at;
    if (run.wait_status && now >= run.next_check && end_tree(run, now)) {
      read_some(id, run);
      all.push_back({id, *run.wait_status});
      at = runs_.erase(at);
    } else {
      ++at;
    }
  }
  return all;
}

// Reads up to the limit. Returns whether there may be more.
bool Children::read_some(const std::string& id, Run& run) const {
  std::array<char, 4096> buffer{};
  std::size_t total = 0;
  while (total < kMaxReadBytes) {
    const ssize_t size = ::read(run.terminal.get(), buffer.data(), buffer.size());
    if (size > 0) {
      on_output_(id, {buffer.data(), static_cast<std::size_t>(size)});
      total += static_cast<std::size_t>(size);
    } else if (size < 0 && errno == EINTR) {
      continue;
    } else {
      run.has_hung_up = size == 0 || errno != EAGAIN;  // EIO: no process has the terminal open
      return false;
    }
  }
  return true;
}

void Children::read_output(time::SteadyTime now) {
  for (auto& [id, run] : runs_) {
    if (!run.has_hung_up && now >= run.next_read && read_some(id, run)) {
      run.next_read = now + kReadPeriod;
    }
  }
}

void Children::add_to_poll(std::vector<pollfd>& waiting, time::SteadyTime now) const {
  for (const auto& [id, run] : runs_) {
    if (!run.has_hung_up && now >= run.next_read) {
      waiting.push_back({run.terminal.get(), POLLIN, 0});
    }
  }
}

std::optional<time::SteadyTime> Children::due(time::SteadyTime now) const {
  std::optional<time::SteadyTime> due;
  const auto take = [&due](time::SteadyTime stamp) { due = std::min(due.value_or(stamp), stamp); };
  for (const auto& [id, run] : runs_) {
    if (!run.has_hung_up && run.next_read > now) {  // afterwards poll() waits for it
      take(run.next_read);
    }
    if (run.wait_status) {
      take(run.next_check);
    }
  }
  return due;
}

void Children::kill_everything() {
  for (time::Duration waited{}; waited < kMaxEndTime; waited += kEndRound) {
    while (::waitpid(-1, nullptr, WNOHANG) > 0) {
    }
    const std::vector<ProcessRow> table = read_processes();
    const std::vector<pid_t> below =
        tree_of(table, [](const ProcessRow& row) { return row.parent == ::getpid(); });
    if (below.empty()) {
      return;
    }
    for (const pid_t pid : below) {
      ::kill(pid, SIGKILL);
    }
    std::this_thread::sleep_for(kEndRound);
  }
}

void Children::kill_strays() const {
  for (const ProcessRow& row : read_processes()) {
    const std::string mark =
        is_orphan(row) ? variable_of(row.pid, kMarkVariable).value_or("") : std::string();
    const bool is_of_a_run =
        std::ranges::any_of(runs_, [&mark](const auto& item) { return item.second.mark == mark; });
    if (mark.starts_with(own_mark_) && !is_of_a_run) {
      ::kill(row.pid, SIGKILL);
    }
  }
}

int Children::kill_leftovers() {
  const std::vector<ProcessRow> table = read_processes();
  std::set<std::string> living;  // marks of running deputies
  for (const ProcessRow& row : table) {
    living.insert(mark_of_process(mark_prefix_, row.pid, row.start_ticks));
  }
  int count = 0;
  for (const ProcessRow& row : table) {
    const std::string mark = variable_of(row.pid, kMarkVariable).value_or("");
    const std::string of_deputy = mark.substr(0, mark.rfind(':') + 1);
    // Another deputy's name may begin like ours, so two numbers must follow the prefix.
    const bool is_ours = mark.starts_with(mark_prefix_) &&
                         std::count(mark.begin() + static_cast<std::ptrdiff_t>(mark_prefix_.size()),
                                    mark.end(), ':') == 2;
    if (is_ours && !living.contains(of_deputy) && !row.is_dead()) {
      count += ::kill(row.pid, SIGKILL) == 0 ? 1 : 0;
    }
  }
  return count;
}

}  // namespace nodmap::procman
