// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/passive_sync.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace nodmap::laser3d {
namespace {

constexpr std::int64_t kStartUs = 1'700'000'000'000'000;

/// A USB line with a latency timer of 1 ms on a busy host: up to 1 ms of waiting, a tail of
/// scheduling, and now and then a stall of up to 30 ms.
class Jitter {
 public:
  explicit Jitter(unsigned seed) : random_(seed) {}
  double operator()() {
    double late_us = timer_us_(random_) + scheduling_us_(random_);
    if (share_(random_) < 0.02) {
      late_us += stall_us_(random_);
    }
    return late_us;
  }

 private:
  std::mt19937 random_;
  std::uniform_real_distribution<> timer_us_{0.0, 1000.0};
  std::exponential_distribution<> scheduling_us_{1.0 / 200.0};
  std::uniform_real_distribution<> stall_us_{0.0, 30'000.0};
  std::uniform_real_distribution<> share_{0.0, 1.0};
};

struct Errors {
  double worst_us = 0.0;
  double worst_stamp_us = 0.0;
  double sum_us = 0.0;
  int count = 0;
};

/// Runs a minute of events; the errors are those after the first two seconds.
Errors run(const DeviceClock& clock, double true_rate, unsigned seed) {
  PassiveSync dut(clock);
  Jitter jitter(seed);
  Errors errors;
  std::int64_t last_stamp_us = 0;
  std::int64_t last_estimate_us = 0;
  const double period_us = clock.tick_us * true_rate;
  const auto step = static_cast<std::int64_t>(std::max(1.0, 10'000.0 / clock.tick_us));
  for (std::int64_t tick = 0; static_cast<double>(tick) * period_us < 60e6; tick += step) {
    const double truth_us = static_cast<double>(tick) * period_us;
    // The host reads events in their order.
    const std::int64_t stamp_us =
        std::max<std::int64_t>(last_stamp_us + 1, kStartUs + std::llround(truth_us + jitter()));
    const std::int64_t estimate_us = dut.to_host_us(tick % clock.wrap_ticks, stamp_us);
    EXPECT_LE(estimate_us, stamp_us);
    EXPECT_GT(estimate_us, last_estimate_us);
    last_stamp_us = stamp_us;
    last_estimate_us = estimate_us;
    if (truth_us > 2e6) {
      const double error_us = std::abs(static_cast<double>(estimate_us - kStartUs) - truth_us);
      errors.worst_us = std::max(errors.worst_us, error_us);
      errors.worst_stamp_us = std::max(
          errors.worst_stamp_us, std::abs(static_cast<double>(stamp_us - kStartUs) - truth_us));
      errors.sum_us += error_us;
      ++errors.count;
    }
  }
  EXPECT_EQ(dut.restarts(), 0);
  return errors;
}

constexpr DeviceClock kMirror{13'320.0, 256, 0.002};
constexpr DeviceClock kServo{1000.0, 32'768, 0.001};

TEST(PassiveSync, BetterThanAMillisecondWhateverTheDrift) {
  for (const DeviceClock& clock : {kMirror, kServo}) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      for (const double drift : {-0.001, -0.0001, 0.0, 0.0005, 0.001}) {
        const Errors errors = run(clock, 1.0 + drift, seed);
        EXPECT_LT(errors.worst_us, 1000.0) << seed << " " << drift;
        EXPECT_LT(errors.sum_us / errors.count, 400.0);
        EXPECT_GT(errors.worst_stamp_us, 20'000.0);  // what the raw stamps would have been
      }
    }
  }
}

TEST(PassiveSync, ADriftBeyondTheBoundIsLateButNeverWild) {
  // A device that runs slower than allowed: the bound from the past lies before the truth, more
  // so every second, until the clocks are declared not to fit.
  PassiveSync dut(kServo);
  double worst_us = 0.0;
  for (int i = 0; i < 60'000; i += 10) {
    const std::int64_t host_us = kStartUs + std::llround(i * 1000.0 * 1.01);
    worst_us = std::max(
        worst_us, std::abs(static_cast<double>(dut.to_host_us(i % 32'768, host_us) - host_us)));
  }
  // 9 ms for each second: 5 ms to be suspicious, two windows to be sure.
  EXPECT_LT(worst_us, 30'000.0);
  EXPECT_GT(dut.restarts(), 0);
}

TEST(PassiveSync, FirstEventIsItsStamp) {
  PassiveSync dut(kServo);
  EXPECT_EQ(dut.to_host_us(123, kStartUs), kStartUs);
}

TEST(PassiveSync, TheCounterWraps) {
  PassiveSync dut({1000.0, 256, 0.0});
  EXPECT_EQ(dut.to_host_us(250, 1'000'000), 1'000'000);
  EXPECT_EQ(dut.to_host_us(4, 1'017'000), 1'010'000);  // ten ticks later, stamped 7 ms late
}

TEST(PassiveSync, ALongSilenceStartsAnew) {
  PassiveSync dut({1000.0, 256, 0.0});
  EXPECT_EQ(dut.to_host_us(0, 1'000'000), 1'000'000);
  EXPECT_EQ(dut.to_host_us(10, 1'200'000), 1'200'000);
}

TEST(PassiveSync, ADeviceThatStartedAgainIsFollowed) {
  PassiveSync dut(kServo);
  EXPECT_EQ(dut.to_host_us(20'000, 1'000'000), 1'000'000);
  EXPECT_EQ(dut.to_host_us(20'010, 1'010'000), 1'010'000);
  // Its count begins at 0: seen as 12.7 s ahead, more than passed, so the stamp bounds it.
  EXPECT_EQ(dut.to_host_us(0, 1'500'000), 1'500'000);
  EXPECT_EQ(dut.to_host_us(10, 1'512'000), 1'510'010);
}

TEST(PassiveSync, AHostClockThatStepsIsFollowed) {
  PassiveSync dut(kServo);
  EXPECT_EQ(dut.to_host_us(0, 1'000'000), 1'000'000);
  EXPECT_EQ(dut.to_host_us(10, 9'010'000), 9'010'000);
  EXPECT_EQ(dut.to_host_us(20, 2'000'000), 2'000'000);
}

TEST(PassiveSync, ALatencyThatGrewForGoodIsAcceptedAfterASecond) {
  PassiveSync dut(kServo);
  std::int64_t estimate_us = 0;
  for (int i = 0; i < 3000; i += 10) {
    const int latency_us = i < 500 ? 0 : 50'000;
    estimate_us = dut.to_host_us(i, kStartUs + i * 1000 + latency_us);
  }
  EXPECT_NEAR(static_cast<double>(estimate_us - kStartUs), 2'990'000.0 + 50'000.0, 3'000.0);
  EXPECT_EQ(dut.restarts(), 1);
}

}  // namespace
}  // namespace nodmap::laser3d
