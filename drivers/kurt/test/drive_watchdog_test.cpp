// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/drive_watchdog.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace nodmap::kurt {
namespace {

constexpr std::int64_t kTimeoutUs = 200'000;
constexpr std::int64_t kUtimeUs = 1'700'000'000'000'000;

/// The next DRIVE of one sender.
DriveRequest request(double forward_mps, std::int64_t utime_us, std::int64_t valid_us = 1'000'000) {
  static std::int64_t seq = 0;
  return {{forward_mps, 0.1}, utime_us, valid_us, seq++};
}

TEST(DriveWatchdog, StandsUntilTheFirstDrive) {
  const DriveWatchdog watchdog(kTimeoutUs);
  EXPECT_FALSE(watchdog.command(0).has_value());
}

TEST(DriveWatchdog, ObeysForTwoHundredMillisecondsAndNotOneMore) {
  DriveWatchdog watchdog(kTimeoutUs);
  ASSERT_EQ(watchdog.offer(request(0.5, kUtimeUs), kUtimeUs, 1000), DriveStatus::kObeyed);
  EXPECT_EQ(watchdog.command(1000)->forward_mps, 0.5);
  EXPECT_EQ(watchdog.command(1000)->yaw_rate_rad_s, 0.1);
  EXPECT_TRUE(watchdog.command(1000 + kTimeoutUs - 1).has_value());
  EXPECT_FALSE(watchdog.command(1000 + kTimeoutUs).has_value());
}

TEST(DriveWatchdog, AShorterValidityHolds) {
  DriveWatchdog watchdog(kTimeoutUs);
  ASSERT_EQ(watchdog.offer(request(0.5, kUtimeUs, 50'000), kUtimeUs, 0), DriveStatus::kObeyed);
  EXPECT_TRUE(watchdog.command(49'999).has_value());
  EXPECT_FALSE(watchdog.command(50'000).has_value());
}

// A DRIVE that was 150 ms on its way is obeyed for the 50 ms that are left.
TEST(DriveWatchdog, TimeOnTheWayCounts) {
  DriveWatchdog watchdog(kTimeoutUs);
  ASSERT_EQ(watchdog.offer(request(0.5, kUtimeUs - 150'000), kUtimeUs, 0), DriveStatus::kObeyed);
  EXPECT_TRUE(watchdog.command(49'999).has_value());
  EXPECT_FALSE(watchdog.command(50'000).has_value());
}

TEST(DriveWatchdog, AStaleDriveIsNotObeyed) {
  DriveWatchdog watchdog(kTimeoutUs);
  EXPECT_EQ(watchdog.offer(request(0.5, kUtimeUs - kTimeoutUs), kUtimeUs, 0), DriveStatus::kStale);
  EXPECT_EQ(watchdog.offer(request(0.5, kUtimeUs - 60'000, 50'000), kUtimeUs, 0),
            DriveStatus::kStale);
  EXPECT_EQ(watchdog.offer(request(0.5, std::numeric_limits<std::int64_t>::min()), kUtimeUs, 0),
            DriveStatus::kStale);
  EXPECT_FALSE(watchdog.command(0).has_value());
}

TEST(DriveWatchdog, ADriveFromTheFutureIsNotObeyed) {
  DriveWatchdog watchdog(kTimeoutUs);
  EXPECT_EQ(watchdog.offer(request(0.5, kUtimeUs + 1'000'000), kUtimeUs, 0),
            DriveStatus::kFromFuture);
  EXPECT_EQ(watchdog.offer(request(0.5, std::numeric_limits<std::int64_t>::max()), kUtimeUs, 0),
            DriveStatus::kFromFuture);
  EXPECT_FALSE(watchdog.command(0).has_value());
  EXPECT_EQ(watchdog.offer(request(0.5, kUtimeUs + 5'001), kUtimeUs, 0), DriveStatus::kFromFuture);
  // Clocks that differ a little do not lengthen its life.
  EXPECT_EQ(watchdog.offer(request(0.5, kUtimeUs + 5'000), kUtimeUs, 0), DriveStatus::kObeyed);
  EXPECT_FALSE(watchdog.command(kTimeoutUs).has_value());
}

// A sender's clock may be ahead. Were its stamp kept as it is, the next command would look older.
TEST(DriveWatchdog, AStampAheadOfOurClockDoesNotMakeLaterCommandsOlder) {
  DriveWatchdog watchdog(kTimeoutUs);
  ASSERT_EQ(watchdog.offer(request(0.5, kUtimeUs + 5'000), kUtimeUs, 0), DriveStatus::kObeyed);
  EXPECT_EQ(watchdog.offer(request(0.7, kUtimeUs + 1'000), kUtimeUs + 1'000, 1'000),
            DriveStatus::kObeyed);
  EXPECT_EQ(watchdog.command(1'000)->forward_mps, 0.7);
}

// The robot is driven at 0.5 m/s, 75 times a second. Somebody else sends 5 m/s, 100 times a second
// and stamped 4 ms ahead, so that each of its commands looks newer than the right ones.
TEST(DriveWatchdog, TwoSendersAreNotObeyedUntilOneHasEnded) {
  DriveWatchdog watchdog(kTimeoutUs);
  auto own = [&watchdog, seq = std::int64_t{5000}](std::int64_t now_us) mutable {
    return watchdog.offer({{0.5, 0.0}, kUtimeUs + now_us, 1'000'000, seq++}, kUtimeUs + now_us,
                          now_us);
  };
  auto forged = [&watchdog, seq = std::int64_t{0}](std::int64_t now_us) mutable {
    return watchdog.offer({{5.0, 0.0}, kUtimeUs + now_us + 4'000, 1'000'000, seq++},
                          kUtimeUs + now_us, now_us);
  };
  std::int64_t now_us = 0;
  const auto run_until = [&](std::int64_t end_us, bool is_attacked) {
    for (; now_us < end_us; now_us += 1000) {
      if (now_us % 13'000 == 0) {
        static_cast<void>(own(now_us));
      }
      if (is_attacked && now_us % 10'000 == 5000) {
        EXPECT_EQ(forged(now_us), DriveStatus::kOtherSender);
      }
      const auto command = watchdog.command(now_us);
      EXPECT_TRUE(!command || command->forward_mps == 0.5);
    }
  };
  run_until(1'000'000, false);
  ASSERT_TRUE(watchdog.command(now_us));
  run_until(1'050'000, true);
  EXPECT_FALSE(watchdog.command(now_us));
  EXPECT_TRUE(watchdog.is_contested(now_us));
  run_until(3'000'000, true);
  EXPECT_FALSE(watchdog.command(now_us));
  run_until(4'050'000, false);
  EXPECT_FALSE(watchdog.is_contested(now_us));
  EXPECT_EQ(watchdog.command(now_us)->forward_mps, 0.5);
}

TEST(DriveWatchdog, NonsenseRevokesWhatWasObeyed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const DriveRequest& nonsense :
       {request(nan, kUtimeUs), request(-infinity, kUtimeUs), request(11.0, kUtimeUs),
        request(0.5, kUtimeUs, 0), request(0.5, kUtimeUs, -1),
        DriveRequest{{0.5, nan}, kUtimeUs, 100'000},
        DriveRequest{{0.5, 19.0}, kUtimeUs, 100'000}}) {
    DriveWatchdog watchdog(kTimeoutUs);
    ASSERT_EQ(watchdog.offer(request(0.5, kUtimeUs), kUtimeUs, 0), DriveStatus::kObeyed);
    EXPECT_NE(watchdog.offer(nonsense, kUtimeUs, 1000), DriveStatus::kObeyed);
    EXPECT_FALSE(watchdog.command(1000).has_value());
  }
}

TEST(DriveWatchdog, AnOlderOneDoesNotReplaceANewerOneThatHolds) {
  DriveWatchdog watchdog(kTimeoutUs);
  ASSERT_EQ(watchdog.offer(request(0.5, kUtimeUs), kUtimeUs, 0), DriveStatus::kObeyed);
  EXPECT_EQ(watchdog.offer(request(0.9, kUtimeUs - 1000), kUtimeUs, 100), DriveStatus::kOutOfOrder);
  EXPECT_EQ(watchdog.command(100)->forward_mps, 0.5);
  // The wall clock was set back by an hour: after the time-out the order starts anew.
  const std::int64_t hour_us = 3'600'000'000;
  EXPECT_EQ(watchdog.offer(request(0.7, kUtimeUs - hour_us), kUtimeUs - hour_us, kTimeoutUs),
            DriveStatus::kObeyed);
}

TEST(DriveWatchdog, RevokedIsRevokedUntilTheNext) {
  DriveWatchdog watchdog(kTimeoutUs);
  ASSERT_EQ(watchdog.offer(request(0.5, kUtimeUs), kUtimeUs, 0), DriveStatus::kObeyed);
  watchdog.revoke();
  EXPECT_FALSE(watchdog.command(0).has_value());
  ASSERT_EQ(watchdog.offer(request(0.5, kUtimeUs + 1), kUtimeUs + 1, 1), DriveStatus::kObeyed);
  EXPECT_TRUE(watchdog.command(1).has_value());
}

TEST(DriveWatchdog, EveryStatusHasItsName) {
  for (const DriveStatus status :
       {DriveStatus::kObeyed, DriveStatus::kNotFinite, DriveStatus::kImplausible,
        DriveStatus::kStale, DriveStatus::kFromFuture, DriveStatus::kOutOfOrder,
        DriveStatus::kOtherSender}) {
    EXPECT_STRNE(name_of(status), "");
  }
}

}  // namespace
}  // namespace nodmap::kurt
