// SPDX-License-Identifier: BSD-3-Clause
// Processor times, and quantiles of what was measured.
#pragma once

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <vector>

namespace nodmap::bench {

inline double cpu_ms(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Processor time of this process, which other load on the machine hardly affects.
inline double process_cpu_ms() {
  return cpu_ms(CLOCK_PROCESS_CPUTIME_ID);
}

/// The same of this thread.
inline double thread_cpu_ms() {
  return cpu_ms(CLOCK_THREAD_CPUTIME_ID);
}

/// The largest value of this share of the values, 0 to 1; 0 without values.
inline double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values.empty()
             ? 0.0
             : values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

}  // namespace nodmap::bench
