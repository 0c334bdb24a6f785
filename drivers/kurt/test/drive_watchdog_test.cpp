// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/drive_watchdog.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace nodmap::kurt {
namespace {

constexpr std::int64_t kTimeoutUs = 200'000;
constexpr std::int64_t kUtimeUs = 1'700'000'000'000'000;

DriveRequest request(double forward_mps, std::int64_t utime_us, std::int64_t valid_us = 1'000'000) {
  return {{forward_mps, 0.1}, utime_us, valid_us};
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
  // Clocks that differ a little do not lengthen its life.
  EXPECT_EQ(watchdog.offer(request(0.5, kUtimeUs + 40'000), kUtimeUs, 0), DriveStatus::kObeyed);
  EXPECT_FALSE(watchdog.command(kTimeoutUs).has_value());
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
        DriveStatus::kStale, DriveStatus::kFromFuture, DriveStatus::kOutOfOrder}) {
    EXPECT_STRNE(name_of(status), "");
  }
}

}  // namespace
}  // namespace nodmap::kurt
