// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/child_process.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <system_error>
#include <utility>

namespace nodmap::procman {
namespace {

constexpr int kCannotRun = 127;

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::system_category(), what);
}

// The array of pointers that execve() needs; they point into `words`, which must outlive it.
std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> all;
  all.reserve(words.size() + 1);
  for (std::string& word : words) {
    all.push_back(word.data());
  }
  all.push_back(nullptr);
  return all;
}

// The path of a program. Must be looked up before the fork: the child may not allocate.
std::string find_program(const std::string& name, const std::string& search_path) {
  if (name.find('/') != std::string::npos) {
    return name;
  }
  std::size_t begin = 0;
  while (begin <= search_path.size()) {
    const std::size_t end = std::min(search_path.find(':', begin), search_path.size());
    const std::string folder = search_path.substr(begin, end - begin);
    std::string candidate = (folder.empty() ? "." : folder) + "/" + name;
    if (::access(candidate.c_str(), X_OK) == 0) {
      return candidate;
    }
    begin = end + 1;
  }
  return name;  // execve() will report that it does not exist
}

bool is_in_name(char c, bool is_first) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
         (!is_first && c >= '0' && c <= '9');
}

// The name of the variable at the start of `text` (after the $), and its length including braces;
// an empty name if there is none.
std::pair<std::string, std::size_t> variable_at(std::string_view text) {
  const bool has_brace = text.starts_with('{');
  std::size_t end = has_brace ? 1 : 0;
  const std::size_t begin = end;
  while (end < text.size() && is_in_name(text[end], end == begin)) {
    ++end;
  }
  std::string name(text.substr(begin, end - begin));
  if (has_brace && (end == text.size() || text[end] != '}')) {
    return {{}, 0};
  }
  return {std::move(name), end + (has_brace ? 1 : 0)};
}

std::string expanded(std::string_view word, const Lookup& lookup) {
  std::string text;
  for (std::size_t at = 0; at < word.size(); ++at) {
    if (word[at] != '$') {
      text += word[at];
      continue;
    }
    const auto [name, length] = variable_at(word.substr(at + 1));
    const std::optional<std::string> value = name.empty() ? std::nullopt : lookup(name);
    if (value) {
      text += *value;
      at += length;
    } else {
      text += '$';
    }
  }
  return text;
}

struct Terminal {
  formats::FileDescriptor ours;
  std::array<char, 128> name{};
};

Terminal open_terminal() {
  Terminal terminal;
  terminal.ours = formats::FileDescriptor(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
  const int fd = terminal.ours.get();
  if (fd < 0 || ::grantpt(fd) != 0 || ::unlockpt(fd) != 0 ||
      ::ptsname_r(fd, terminal.name.data(), terminal.name.size()) != 0 ||
      ::fcntl(fd, F_SETFL, O_NONBLOCK) != 0) {
    fail("a pseudo-terminal");
  }
  return terminal;
}

// Everything that the child needs, prepared before the fork.
struct Launch {
  const char* terminal_name = nullptr;
  const char* program = nullptr;
  char* const* arguments = nullptr;
  char* const* environment = nullptr;
  pid_t parent = -1;
  Resources resources;
};

void write_error(const char* text) noexcept {
  if (::write(STDERR_FILENO, text, std::strlen(text)) < 0) {
    ::_exit(kCannotRun);  // the terminal has been closed
  }
}

bool set_realtime(int priority) noexcept {
  const sched_param realtime{priority};
  return ::sched_setscheduler(0, SCHED_RR, &realtime) == 0;
}

bool limit_memory(int memory_mb) noexcept {
  const rlim_t bytes = rlim_t{1'000'000} * static_cast<rlim_t>(memory_mb);
  const rlimit limit{bytes, bytes};
  return ::setrlimit(RLIMIT_DATA, &limit) == 0;
}

bool pin_to(const std::vector<int>& cpus) noexcept {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int cpu : cpus) {
    CPU_SET(cpu, &set);
  }
  return ::sched_setaffinity(0, sizeof(set), &set) == 0;
}

// Applies what the command asks for. If the system refuses something, the program runs without it,
// and its output says so.
void apply_resources(const Resources& resources) noexcept {
  if (resources.nice != 0 && ::setpriority(PRIO_PROCESS, 0, resources.nice) != 0) {
    write_error("nodmap-deputy: cannot set the nice value\n");
  }
  if (resources.realtime != 0 && !set_realtime(resources.realtime)) {
    write_error("nodmap-deputy: real-time priority is not permitted (see RLIMIT_RTPRIO)\n");
  }
  if (resources.memory_mb != 0 && !limit_memory(resources.memory_mb)) {
    write_error("nodmap-deputy: cannot limit the memory\n");
  }
  if (!resources.cpus.empty() && !pin_to(resources.cpus)) {
    write_error("nodmap-deputy: this host does not have these cpus\n");
  }
}

// Runs in the child, up to execve(). Only calls that are safe after the fork of a process with
// threads: no allocation, no lock, no stdio.
[[noreturn]] void become(const Launch& launch) noexcept {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != launch.parent) {
    ::_exit(kCannotRun);  // the deputy died before the prctl()
  }
  ::setsid();
  const int fd = ::open(launch.terminal_name, O_RDWR);
  if (fd < 0) {
    ::_exit(kCannotRun);
  }
  ::ioctl(fd, TIOCSCTTY, 0);
  ::dup2(fd, STDIN_FILENO);
  ::dup2(fd, STDOUT_FILENO);
  ::dup2(fd, STDERR_FILENO);
  // LCM opens its sockets without CLOEXEC.
  ::close_range(STDERR_FILENO + 1, UINT_MAX, 0);
  apply_resources(launch.resources);
  // Commands do not inherit the service's right to change other processes (CAP_SYS_NICE).
  ::prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
  struct sigaction standard {};
  standard.sa_handler = SIG_DFL;
  for (int signal = 1; signal < NSIG; ++signal) {
    ::sigaction(signal, &standard, nullptr);  // fails for SIGKILL and SIGSTOP, as it should
  }
  sigset_t none;
  ::sigemptyset(&none);
  // Last: signals sent meanwhile are pending, and now have their default effect.
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::execve(launch.program, launch.arguments, launch.environment);
  const char* reason = ::strerrordesc_np(errno);
  write_error("nodmap-deputy: cannot run ");
  write_error(launch.program);
  write_error(": ");
  write_error(reason != nullptr ? reason : "unknown error");
  write_error("\n");
  ::_exit(kCannotRun);
}

}  // namespace

ExecLine parse_exec_line(std::string_view line, const Lookup& lookup) {
  ExecLine exec = split_exec_line(line);
  for (std::string& argument : exec.arguments) {
    argument = expanded(argument, lookup);
  }
  return exec;
}

Child start_child(const Program& program) {
  std::vector<std::string> words = program.arguments;
  std::vector<std::string> variables = program.environment;
  const std::vector<char*> arguments = pointers(words);
  const std::vector<char*> environment = pointers(variables);
  const std::string file = find_program(words.at(0), program.search_path);
  Terminal terminal = open_terminal();
  const Launch launch{terminal.name.data(), file.c_str(), arguments.data(),
                      environment.data(),   ::getpid(),   program.resources};
  // No signal may reach the child while it still has the deputy's signal handling.
  sigset_t all;
  sigset_t before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t pid = ::fork();
  if (pid == 0) {
    become(launch);
  }
  const int error = errno;
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (pid < 0) {
    errno = error;
    fail("fork");
  }
  return {pid, std::move(terminal.ours)};
}

}  // namespace nodmap::procman
