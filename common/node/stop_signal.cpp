// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/stop_signal.hpp"

#include <csignal>

namespace nodmap::node {
namespace {

volatile std::sig_atomic_t g_stop = 0;  // NOLINT: a signal handler can reach nothing but a global

}  // namespace

void catch_stop_signals() {
  g_stop = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { g_stop = 1; };
  ::sigemptyset(&action.sa_mask);
  // Without SA_RESTART: a wait for messages ends at once.
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
}

bool stop_requested() {
  return g_stop != 0;
}

}  // namespace nodmap::node
