// SPDX-License-Identifier: BSD-3-Clause
#include "tools/watch/display.hpp"

#include <ostream>

namespace nodmap::watch {
namespace {

constexpr time::Duration kTerminalPeriod = 100ms;
constexpr time::Duration kFilePeriod = 5s;

}  // namespace

Display::Display(std::ostream& out, bool is_terminal) : out_(out), is_terminal_(is_terminal) {
  if (is_terminal_) {
    next_ = time::SteadyTime{};  // shows at once that no data come
  }
}

void Display::show(const Overview& overview, time::SteadyTime now) {
  if (!next_ && overview.scans().total() > 0) {
    next_ = now + kFilePeriod;
  }
  if (next_ && now >= *next_) {
    write(overview, now);
    next_ = now + (is_terminal_ ? kTerminalPeriod : kFilePeriod);
  }
}

void Display::end(const Overview& overview, time::SteadyTime now) {
  if (next_) {
    write(overview, now);
  }
  if (is_terminal_) {
    out_ << std::endl;
  }
}

void Display::write(const Overview& overview, time::SteadyTime now) {
  out_ << (is_terminal_ ? "\r\033[K" : "") << status_line(overview, now)
       << (is_terminal_ ? "" : "\n") << std::flush;
}

}  // namespace nodmap::watch
