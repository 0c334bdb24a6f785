// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace nodmap::node {

/// Processor time since the machine started, in ticks, of all processors together.
struct CpuTicks {
  std::uint64_t busy = 0;
  std::uint64_t total = 0;
};

/// Parses the text of /proc/stat; empty if it is not valid.
[[nodiscard]] std::optional<CpuTicks> parse_cpu_ticks(const std::string& proc_stat);

/// The ratio of `part` to `total`, 0 to 1; 0 if `part` exceeds `total` or `total` is 0.
[[nodiscard]] float share_of(std::uint64_t part, std::uint64_t total);

/// Measures how busy this machine's processors are between two samples.
class CpuLoad {
 public:
  /// Takes a sample of /proc/stat.
  void sample() { take(read()); }
  void take(const std::optional<CpuTicks>& ticks);

  /// The fraction of all processors' time that was used between the last two samples, 0 to 1;
  /// negative before there are two.
  [[nodiscard]] float share() const { return share_; }
  /// Number of ticks between the last two samples, of all processors together; 0 before there are
  /// two.
  [[nodiscard]] std::uint64_t elapsed_ticks() const { return elapsed_ticks_; }

 private:
  [[nodiscard]] static std::optional<CpuTicks> read();

  std::optional<CpuTicks> last_;
  float share_ = -1.0F;
  std::uint64_t elapsed_ticks_ = 0;
};

}  // namespace nodmap::node
