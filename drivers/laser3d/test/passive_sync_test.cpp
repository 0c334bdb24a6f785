// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/passive_sync.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace nodmap::laser3d {
namespace passive_sync_test {

time::SteadyTime at(time::Duration since_start) {
  return time::SteadyTime(since_start);
}

constexpr time::SteadyTime kStart{1'700'000'000s};

// A USB line with a latency timer of 1 ms on a busy host: up to 1 ms of waiting, scheduling
// delays, and occasional stalls of up to 30 ms.
class Jitter {
 public:
  explicit Jitter(unsigned seed) : random_(seed) {}
  time::FineDuration operator()() {
    double late_us = timer_us_(random_) + scheduling_us_(random_);
    if (share_(random_) < 0.02) {
      late_us += stall_us_(random_);
    }
    return time::FineDuration(late_us);
  }

 private:
  std::mt19937 random_;
  std::uniform_real_distribution<> timer_us_{0.0, 1000.0};
  std::exponential_distribution<> scheduling_us_{1.0 / 200.0};
  std::uniform_real_distribution<> stall_us_{0.0, 30'000.0};
  std::uniform_real_distribution<> share_{0.0, 1.0};
};

struct Errors {
  time::FineDuration worst{};
  time::FineDuration worst_stamp{};
  time::FineDuration sum{};
  int count = 0;
};

// Runs a minute of events; the errors are those after the first two seconds.
Errors run(const DeviceClock& clock, double true_rate, unsigned seed) {
  PassiveSync dut(clock);
  Jitter jitter(seed);
  Errors errors;
  time::SteadyTime last_stamp;
  time::SteadyTime last_estimate;
  const time::FineDuration period = clock.tick * true_rate;
  const auto step = static_cast<std::int64_t>(std::max(1.0, 10ms / clock.tick));
  for (std::int64_t tick = 0; static_cast<double>(tick) * period < 60s; tick += step) {
    const time::FineDuration truth = static_cast<double>(tick) * period;
    // The host reads events in their order.
    const time::SteadyTime stamp =
        std::max(last_stamp + 1us, kStart + time::rounded(truth + jitter()));
    const time::SteadyTime estimate = dut.to_host(tick % clock.wrap_ticks, stamp);
    EXPECT_LE(estimate, stamp);
    EXPECT_GT(estimate, last_estimate);
    last_stamp = stamp;
    last_estimate = estimate;
    if (truth > 2s) {
      const time::FineDuration error = std::chrono::abs((estimate - kStart) - truth);
      errors.worst = std::max(errors.worst, error);
      errors.worst_stamp = std::max(errors.worst_stamp,
                                    time::FineDuration(std::chrono::abs((stamp - kStart) - truth)));
      errors.sum += error;
      ++errors.count;
    }
  }
  EXPECT_EQ(dut.restarts(), 0);
  return errors;
}

constexpr DeviceClock kMirror{13'320us, 256, 0.002};
constexpr DeviceClock kServo{1ms, 32'768, 0.001};

TEST(PassiveSync, BetterThanAMillisecondWhateverTheDrift) {
  for (const DeviceClock& clock : {kMirror, kServo}) {
    for (unsigned seed = 0; seed < 20; ++seed) {
      for (const double drift : {-0.001, -0.0001, 0.0, 0.0005, 0.001}) {
        const Errors errors = run(clock, 1.0 + drift, seed);
        EXPECT_LT(errors.worst, 1ms) << seed << " " << drift;
        EXPECT_LT(errors.sum / errors.count, 400us);
        EXPECT_GT(errors.worst_stamp, 20ms);  // what the raw stamps would have been
      }
    }
  }
}

TEST(PassiveSync, ADriftBeyondTheBoundIsLateButNeverWild) {
  // A device that runs slower than allowed: the bound from the past is too early, by more every
  // second, until the clocks are declared to disagree.
  PassiveSync dut(kServo);
  time::Duration worst{};
  for (int i = 0; i < 60'000; i += 10) {
    const time::SteadyTime stamp = kStart + i * 1010us;
    worst = std::max(worst, std::chrono::abs(dut.to_host(i % 32'768, stamp) - stamp));
  }
  // The error grows by 9 ms per second: 5 ms until it is suspicious, then two windows of a second
  // until it is detected.
  EXPECT_LT(worst, 23ms);
  EXPECT_GT(dut.restarts(), 0);
}

TEST(PassiveSync, FirstEventIsItsStamp) {
  PassiveSync dut(kServo);
  EXPECT_EQ(dut.to_host(123, kStart), kStart);
}

TEST(PassiveSync, TheCounterWraps) {
  PassiveSync dut({1ms, 256, 0.0});
  EXPECT_EQ(dut.to_host(250, at(1s)), at(1s));
  EXPECT_EQ(dut.to_host(4, at(1017ms)), at(1010ms));  // ten ticks later, stamped 7 ms late
}

TEST(PassiveSync, ALongSilenceStartsAgain) {
  PassiveSync dut({1ms, 256, 0.0});
  EXPECT_EQ(dut.to_host(0, at(1s)), at(1s));
  EXPECT_EQ(dut.to_host(10, at(1200ms)), at(1200ms));
}

TEST(PassiveSync, ARestartedDeviceIsFollowed) {
  PassiveSync dut(kServo);
  EXPECT_EQ(dut.to_host(20'000, at(1s)), at(1s));
  EXPECT_EQ(dut.to_host(20'010, at(1010ms)), at(1010ms));
  // Its counter restarts at 0, which looks like 12.7 s ahead, more than has passed, so the stamp is
  // the bound.
  EXPECT_EQ(dut.to_host(0, at(1500ms)), at(1500ms));
  EXPECT_EQ(dut.to_host(10, at(1512ms)), at(1'510'010us));
}

TEST(PassiveSync, AHostClockThatStepsIsFollowed) {
  PassiveSync dut(kServo);
  EXPECT_EQ(dut.to_host(0, at(1s)), at(1s));
  EXPECT_EQ(dut.to_host(10, at(9010ms)), at(9010ms));
  EXPECT_EQ(dut.to_host(20, at(2s)), at(2s));
}

// As that of a USB adapter whose latency timer was set from 1 ms to 16 ms.
TEST(PassiveSync, ALatencyThatGrewForGoodIsAcceptedAfterASecond) {
  PassiveSync dut(kServo);
  time::SteadyTime estimate;
  for (int i = 0; i < 3000; i += 10) {
    const time::Duration latency = i < 500 ? 0ms : 15ms;
    estimate = dut.to_host(i, kStart + i * 1ms + latency);
  }
  EXPECT_EQ(estimate, kStart + 2990ms + 15ms);
  EXPECT_EQ(dut.restarts(), 1);
  EXPECT_EQ(dut.delay(), 0us);
}

// No clock drifts by 100 ms within a second, so the events are that old.
TEST(PassiveSync, AStepOfTheLatencyIsADelayUntilItIsOver) {
  for (const DeviceClock& clock : {kMirror, kServo}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      PassiveSync dut(clock);
      Jitter jitter(seed);
      const auto step = static_cast<std::int64_t>(std::max(1.0, 10ms / clock.tick));
      time::SteadyTime last_stamp;
      bool was_reported = false;
      for (std::int64_t tick = 0; static_cast<double>(tick) * clock.tick < 20s; tick += step) {
        const time::FineDuration truth = static_cast<double>(tick) * clock.tick;
        const bool is_late = truth > 5s && truth < 15s;
        const time::SteadyTime stamp = std::max(
            last_stamp + 1us, kStart + time::rounded(truth + jitter() + (is_late ? 100ms : 0ms)));
        last_stamp = stamp;
        const time::SteadyTime estimate = dut.to_host(tick % clock.wrap_ticks, stamp);
        // The bound runs away from the events by its drift, 0.2 % of ten seconds, and the jitter.
        EXPECT_LT(std::chrono::abs((estimate - kStart) - truth), 22ms) << truth.count();
        if (truth > 7s && truth < 15s) {
          was_reported = true;
          EXPECT_GT(dut.delay(), 75ms);
        }
        if (truth > 15.2s) {
          EXPECT_EQ(dut.delay(), 0us);
        }
      }
      EXPECT_TRUE(was_reported);
      EXPECT_EQ(dut.restarts(), 0);
    }
  }
}

// The host lets the process wait for 150 ms once a second: most events of each second are on time.
TEST(PassiveSync, ABusyHostIsNoDelay) {
  PassiveSync dut(kServo);
  for (int i = 0; i < 20'000; i += 10) {
    const int stamped = i % 1000 < 150 ? i / 1000 * 1000 + 150 : i;
    const time::SteadyTime stamp = kStart + stamped * 1ms;
    EXPECT_LE(dut.to_host(i % 32'768, stamp), stamp);
    EXPECT_EQ(dut.delay(), 0us);
  }
  EXPECT_EQ(dut.restarts(), 0);
}

TEST(PassiveSync, ANewLineEndsADelay) {
  PassiveSync dut(kServo);
  int tick = 0;
  for (; tick < 5000; tick += 10) {
    const time::Duration latency = tick < 1000 ? 0ms : 100ms;
    EXPECT_LE(dut.to_host(tick, kStart + tick * 1ms + latency), kStart + tick * 1ms + latency);
  }
  EXPECT_GT(dut.delay(), 0us);
  dut.reset();
  EXPECT_EQ(dut.delay(), 0us);
  EXPECT_EQ(dut.to_host(tick, kStart + 5100ms), kStart + 5100ms);
}

}  // namespace passive_sync_test
}  // namespace nodmap::laser3d
