// SPDX-License-Identifier: BSD-3-Clause
#include "procman/sheriff/lone_deputies.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <set>
#include <system_error>

#include "procman/protocol/host.hpp"

namespace nodmap::procman {
namespace {

// Runs in the child, up to execv(), with all signals blocked.
[[noreturn]] void become(const std::vector<char*>& arguments, pid_t parent,
                         const sigset_t& signals) noexcept {
  // Its own process group: Ctrl-C on the terminal is for the sheriff, which then stops the
  // deputy. A second signal would kill its commands at once.
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::signal(signal, SIG_DFL);
  }
  ::pthread_sigmask(SIG_SETMASK, &signals, nullptr);
  if (::getppid() == parent) {
    ::execv(arguments.front(), arguments.data());
  }
  ::_exit(127);
}

pid_t start(std::vector<std::string> words) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) {
    arguments.push_back(word.data());
  }
  arguments.push_back(nullptr);
  const pid_t parent = ::getpid();
  // No signal may reach the child while it still has the sheriff's handlers, which would swallow
  // it: then the deputy would serve for ever.
  sigset_t all;
  sigset_t before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t pid = ::fork();
  if (pid == 0) {
    become(arguments, parent, before);
  }
  const int error = errno;
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (pid < 0) {
    throw std::system_error(error, std::system_category(), "fork");
  }
  return pid;
}

}  // namespace

LoneDeputies::LoneDeputies(const std::string& config_file, const Config& config,
                           const std::string& lcm_url) {
  std::set<std::string> ids;
  for (const Command& command : config.commands) {
    ids.insert(command.deputy);
  }
  for (const std::string& id : ids) {
    std::vector<std::string> words = {
        own_folder() / "nodmap-deputy", config_file, "--id", id, "--log-level", "warn"};
    if (!lcm_url.empty()) {
      words.insert(words.end(), {"--lcm-url", lcm_url});
    }
    deputies_.push_back(start(std::move(words)));
  }
}

bool LoneDeputies::stop() {
  for (const pid_t pid : deputies_) {
    ::kill(pid, SIGTERM);
  }
  bool all_well = true;
  for (const pid_t pid : deputies_) {
    int status = 0;
    while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
    all_well = all_well && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
  deputies_.clear();
  return all_well;
}

}  // namespace nodmap::procman
