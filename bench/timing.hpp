// SPDX-License-Identifier: BSD-3-Clause
// Processor times.
#pragma once

#include <ctime>

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

}  // namespace nodmap::bench
