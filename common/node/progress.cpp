// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace nodmap::node {

Progress::Progress(std::string what, std::int64_t total)
    : what_(std::move(what)),
      total_(std::max<std::int64_t>(1, total)),
      on_terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (on_terminal_) {
    std::fputs("\r\033[K", stderr);
  }
}

void Progress::show(std::int64_t done) {
  // The clock is asked every 64th time only: a replay handles some 100 000 messages per second.
  if (!on_terminal_ || (calls_++ % 64U) != 0) {
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  if (now - shown_ < std::chrono::milliseconds(100)) {
    return;
  }
  shown_ = now;
  constexpr int kWidth = 40;
  const double share =
      std::clamp(static_cast<double>(done) / static_cast<double>(total_), 0.0, 1.0);
  const std::string bar(static_cast<std::size_t>(share * kWidth), '#');
  std::fprintf(stderr, "\r%s [%-40s] %3d %%", what_.c_str(), bar.c_str(),
               static_cast<int>(100.0 * share));
}

}  // namespace nodmap::node
