// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/latency.hpp"

#include <gtest/gtest.h>

namespace nodmap::bus {
namespace latency_test {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

TEST(LatencyMeter, EmptyIsZero) {
  const auto summary = LatencyMeter().summary();
  EXPECT_EQ(summary.count, 0);
  EXPECT_EQ(summary.p50_us, 0.0);
  EXPECT_EQ(summary.max_us, 0.0);
}

TEST(LatencyMeter, PercentilesWithinABin) {
  LatencyMeter meter;
  for (int i = 1; i <= 1000; ++i) {
    meter.record(microseconds(i));
  }
  const auto summary = meter.summary();
  // A bin is a sixteenth of an octave wide: 4.4 %.
  EXPECT_NEAR(summary.p50_us, 500.0, 0.045 * 500.0);
  EXPECT_NEAR(summary.p99_us, 990.0, 0.045 * 990.0);
  EXPECT_EQ(summary.max_us, 1000.0);
  EXPECT_EQ(summary.count, 1000);
}

TEST(LatencyMeter, AcceptsZeroNegativeAndHours) {
  LatencyMeter meter;
  meter.record(nanoseconds(0));
  meter.record(nanoseconds(-5));
  meter.record(std::chrono::hours(24));
  EXPECT_EQ(meter.summary().count, 3);
  EXPECT_DOUBLE_EQ(meter.summary().max_us, 86400e6);
}

// STATUS reports the last second, result.json the whole run.
TEST(LatencyMeter, ASummarySinceTheLastOneLeavesTheSummaryOfAll) {
  LatencyMeter meter;
  meter.record(microseconds(500));
  EXPECT_EQ(meter.summary_since_last().count, 1);
  EXPECT_EQ(meter.summary_since_last().count, 0);
  meter.record(microseconds(5));
  EXPECT_EQ(meter.summary_since_last().max_us, 5.0);
  meter.record(microseconds(50));
  EXPECT_EQ(meter.summary().count, 3);
  EXPECT_EQ(meter.summary().max_us, 500.0);
  EXPECT_NEAR(meter.summary().p50_us, 50.0, 0.045 * 50.0);  // within a bin
}

}  // namespace latency_test
}  // namespace nodmap::bus
