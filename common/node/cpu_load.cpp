// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/cpu_load.hpp"

#include <fstream>
#include <sstream>

namespace nodmap::node {

std::optional<CpuTicks> parse_cpu_ticks(const std::string& proc_stat) {
  std::istringstream in(proc_stat);
  std::string name;
  std::uint64_t user = 0;
  std::uint64_t nice = 0;
  std::uint64_t system = 0;
  std::uint64_t idle = 0;
  if (!(in >> name >> user >> nice >> system >> idle) || name != "cpu") {
    return std::nullopt;
  }
  const std::uint64_t busy = user + nice + system;
  return CpuTicks{busy, busy + idle};
}

float share_of(std::uint64_t part, std::uint64_t total) {
  return total == 0 || part > total
             ? 0.0F
             : static_cast<float>(static_cast<double>(part) / static_cast<double>(total));
}

void CpuLoad::take(const std::optional<CpuTicks>& ticks) {
  elapsed_ticks_ = 0;
  if (ticks && last_ && ticks->total >= last_->total && ticks->busy >= last_->busy) {
    elapsed_ticks_ = ticks->total - last_->total;
    share_ = share_of(ticks->busy - last_->busy, elapsed_ticks_);
  }
  last_ = ticks;
}

std::optional<CpuTicks> CpuLoad::read() {
  std::ifstream in("/proc/stat");
  std::string line;
  std::getline(in, line);
  return parse_cpu_ticks(line);
}

}  // namespace nodmap::node
