// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace nodmap::time {

/// One moment on two clocks: stamps of messages are of the wall clock, intervals of the other one.
struct Moment {
  std::int64_t utime_us = 0;   ///< since the epoch; may be set
  std::int64_t steady_us = 0;  ///< never steps
};

}  // namespace nodmap::time
