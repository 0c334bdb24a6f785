// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace nodmap::node {

/// The processors' time so far, in ticks.
struct CpuTicks {
  std::uint64_t busy = 0;
  std::uint64_t total = 0;
};

/// From the text of /proc/stat; nothing where it is not one.
[[nodiscard]] std::optional<CpuTicks> parse_cpu_ticks(const std::string& proc_stat);

/// The share of `total` that `part` is; 0 where that makes no sense.
[[nodiscard]] float share_of(std::uint64_t part, std::uint64_t total);

/// How busy this machine's processors are, from one sample to the next.
class CpuLoad {
 public:
  /// Takes a sample of /proc/stat.
  void sample() { take(read()); }
  void take(const std::optional<CpuTicks>& ticks);

  /// The share of all processors' time that was used between the last two samples, 0 to 1; negative
  /// before there are two.
  [[nodiscard]] float share() const { return share_; }
  /// The ticks between them, of all processors together; 0 before there are two.
  [[nodiscard]] std::uint64_t elapsed_ticks() const { return elapsed_ticks_; }

 private:
  [[nodiscard]] static std::optional<CpuTicks> read();

  std::optional<CpuTicks> last_;
  float share_ = -1.0F;
  std::uint64_t elapsed_ticks_ = 0;
};

}  // namespace nodmap::node
