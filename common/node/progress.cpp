// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace nodmap::node {
namespace {

// Before this time the remaining time cannot be estimated.
constexpr double kMinElapsedS = 1.0;
constexpr double kMinShare = 0.02;

}  // namespace

std::string progress_line(const std::string& what, double share, double elapsed_s) {
  constexpr int kWidth = 40;
  const double done = std::clamp(share, 0.0, 1.0);
  const std::string bar(static_cast<std::size_t>(done * kWidth), '#');
  std::string line(what.size() + 80, ' ');
  const int length = std::snprintf(line.data(), line.size(), "%s [%-40s] %3d %%", what.c_str(),
                                   bar.c_str(), static_cast<int>(100.0 * done));
  line.resize(static_cast<std::size_t>(length));
  if (elapsed_s < kMinElapsedS || done < kMinShare) {
    return line;
  }
  const auto left_s = static_cast<int>(std::ceil(elapsed_s * (1.0 - done) / done));
  return line + ", about " +
         (left_s < 120 ? std::to_string(left_s) + " s"
                       : std::to_string((left_s + 59) / 60) + " min") +
         " left";
}

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
  // Reads the clock only at every 64th call: a replay handles about 100,000 messages per second.
  if (!on_terminal_ || (calls_++ % 64U) != 0) {
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  if (now - shown_ < std::chrono::milliseconds(100)) {
    return;
  }
  shown_ = now;
  const std::string line =
      progress_line(what_, static_cast<double>(done) / static_cast<double>(total_),
                    std::chrono::duration<double>(now - began_).count());
  std::fprintf(stderr, "\r%s\033[K", line.c_str());
}

}  // namespace nodmap::node
