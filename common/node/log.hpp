// SPDX-License-Identifier: BSD-3-Clause
// The logger, for .cpp files of nodes and programs only: `log::get().warn("...")`. Levels: error
// (the process cannot do its work), warn (somebody should look), info (milestones), debug (for
// developers).
#pragma once

#include <spdlog/spdlog.h>

#include <chrono>
#include <string>

namespace nodmap::log {

/// Names the process in every line and sets the level (trace, debug, info, warn, error, off). Lines
/// go to stderr, so that stdout stays for results. Throws std::invalid_argument for another level.
void start(const std::string& process_name, const std::string& level);

[[nodiscard]] inline spdlog::logger& get() {
  return *spdlog::default_logger_raw();
}

/// Limits how often a repeated message is logged.
class Throttle {
 public:
  explicit Throttle(std::chrono::seconds period = std::chrono::seconds(5)) : period_(period) {}

  /// Whether the period has passed since this last returned true.
  [[nodiscard]] bool ready() {
    const auto now = std::chrono::steady_clock::now();
    if (used_ && now - last_ < period_) {
      return false;
    }
    used_ = true;
    last_ = now;
    return true;
  }

 private:
  std::chrono::steady_clock::duration period_;
  std::chrono::steady_clock::time_point last_;
  bool used_ = false;
};

}  // namespace nodmap::log
