// SPDX-License-Identifier: BSD-3-Clause
#include "procman/protocol/wait_status.hpp"

#include <sys/wait.h>

#include <csignal>
#include <cstring>

namespace nodmap::procman {

std::string describe_end(int wait_status) {
  if (wait_status == 0) {
    return {};
  }
  if (WIFSIGNALED(wait_status)) {
    const int signal = WTERMSIG(wait_status);
    const char* name = ::sigdescr_np(signal);
    return "killed by signal " + std::to_string(signal) +
           (name != nullptr ? " (" + std::string(name) + ")" : "");
  }
  return "exit " + std::to_string(WEXITSTATUS(wait_status));
}

bool may_be_a_stop(int wait_status, int stop_signal) {
  if (wait_status == 0) {
    return true;
  }
  const int signal = WIFSIGNALED(wait_status) ? WTERMSIG(wait_status) : 0;
  return signal == SIGTERM || signal == SIGINT || signal == SIGKILL ||
         (signal != 0 && signal == stop_signal);
}

}  // namespace nodmap::procman
