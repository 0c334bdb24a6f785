// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/core/noncopyable.hpp>
#include <chrono>
#include <cstdint>
#include <string>

namespace nodmap::node {

/// Formats one line: a bar, the completed fraction (`share`, 0 to 1) and, once it can be estimated,
/// the remaining time.
[[nodiscard]] std::string progress_line(const std::string& what, double share, double elapsed_s);

/// Shows a progress bar on stderr; silent if stderr is not a terminal.
class Progress : private boost::noncopyable {
 public:
  Progress(std::string what, std::int64_t total);
  ~Progress();

  /// Cheap enough to be called for every message.
  void show(std::int64_t done);

 private:
  std::string what_;
  std::int64_t total_;
  bool on_terminal_;
  std::uint32_t calls_ = 0;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point shown_;
};

}  // namespace nodmap::node
