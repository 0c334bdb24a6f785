// SPDX-License-Identifier: BSD-3-Clause
#include "common/geometry/clock.hpp"

#include <gtest/gtest.h>

namespace nodmap::time {
namespace clock_test {

// Two clocks that are an hour apart. Reading one takes 1 us, and with the `interrupted`th reading
// 10 ms.
struct Clocks {
  [[nodiscard]] SteadyTime read() {
    now += ++num_read == interrupted ? 10ms : 1us;
    return now;
  }
  [[nodiscard]] Moment moment() {
    return read_together([this] { return Timestamp(read().time_since_epoch() + 1h); },
                         [this] { return read(); });
  }

  int interrupted = 0;
  SteadyTime now{5s};
  int num_read = 0;
};

TEST(Clock, AnInterruptionBetweenTwoReadingsSetsNoStampOff) {
  for (int interrupted = 0; interrupted <= 4; ++interrupted) {
    Clocks clocks{.interrupted = interrupted};
    const Moment moment = clocks.moment();
    EXPECT_NEAR(seconds(moment.wall - Timestamp(1h) - (moment.steady - SteadyTime{})), 0.0, 1e-5)
        << interrupted;
  }
}

}  // namespace clock_test
}  // namespace nodmap::time
