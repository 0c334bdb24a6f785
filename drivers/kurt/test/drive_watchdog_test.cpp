// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/drive_watchdog.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <string>

namespace nodmap::kurt {
namespace drive_watchdog_test {

constexpr time::Duration kTimeout = 200ms;
constexpr time::SteadyTime kSteady{5s};
constexpr time::Timestamp kWall{1'700'000'000s};

constexpr bus::Sender kOwn{0x7F000001, 40'000};
constexpr bus::Sender kOther{0x7F000001, 40'001};

DriveRequest request(double forward_mps, time::Timestamp stamp, time::Duration validity = 1s) {
  return {{forward_mps, 0.1}, stamp, validity, kOwn};
}

TEST(DriveWatchdog, IsStationaryUntilTheFirstDrive) {
  const DriveWatchdog watchdog(kTimeout);
  EXPECT_FALSE(watchdog.command(kSteady).has_value());
}

TEST(DriveWatchdog, ObeysForTwoHundredMillisecondsAndNotOneMore) {
  DriveWatchdog watchdog(kTimeout);
  ASSERT_EQ(watchdog.offer(request(0.5, kWall), kWall, kSteady + 1ms), DriveStatus::kObeyed);
  EXPECT_EQ(watchdog.command(kSteady + 1ms)->forward_mps, 0.5);
  EXPECT_EQ(watchdog.command(kSteady + 1ms)->yaw_rate_rad_s, 0.1);
  EXPECT_TRUE(watchdog.command(kSteady + 1ms + kTimeout - 1us).has_value());
  EXPECT_FALSE(watchdog.command(kSteady + 1ms + kTimeout).has_value());
}

TEST(DriveWatchdog, AShorterValidityHolds) {
  DriveWatchdog watchdog(kTimeout);
  ASSERT_EQ(watchdog.offer(request(0.5, kWall, 50ms), kWall, kSteady), DriveStatus::kObeyed);
  EXPECT_TRUE(watchdog.command(kSteady + 49'999us).has_value());
  EXPECT_FALSE(watchdog.command(kSteady + 50ms).has_value());
}

// A DRIVE that was 150 ms on its way is obeyed for the 50 ms that are left.
TEST(DriveWatchdog, TimeInTransitCounts) {
  DriveWatchdog watchdog(kTimeout);
  ASSERT_EQ(watchdog.offer(request(0.5, kWall - 150ms), kWall, kSteady), DriveStatus::kObeyed);
  EXPECT_TRUE(watchdog.command(kSteady + 49'999us).has_value());
  EXPECT_FALSE(watchdog.command(kSteady + 50ms).has_value());
}

TEST(DriveWatchdog, AStaleDriveIsNotObeyed) {
  DriveWatchdog watchdog(kTimeout);
  EXPECT_EQ(watchdog.offer(request(0.5, kWall - kTimeout), kWall, kSteady), DriveStatus::kStale);
  EXPECT_EQ(watchdog.offer(request(0.5, kWall - 60ms, 50ms), kWall, kSteady), DriveStatus::kStale);
  EXPECT_EQ(watchdog.offer(request(0.5, time::from_utime(std::numeric_limits<std::int64_t>::min())),
                           kWall, kSteady),
            DriveStatus::kStale);
  EXPECT_FALSE(watchdog.command(kSteady).has_value());
}

TEST(DriveWatchdog, ADriveFromTheFutureIsNotObeyed) {
  DriveWatchdog watchdog(kTimeout);
  EXPECT_EQ(watchdog.offer(request(0.5, kWall + 1s), kWall, kSteady), DriveStatus::kFromFuture);
  EXPECT_EQ(watchdog.offer(request(0.5, time::from_utime(std::numeric_limits<std::int64_t>::max())),
                           kWall, kSteady),
            DriveStatus::kFromFuture);
  EXPECT_FALSE(watchdog.command(kSteady).has_value());
  EXPECT_EQ(watchdog.offer(request(0.5, kWall + 5001us), kWall, kSteady), DriveStatus::kFromFuture);
  // Clocks that differ slightly do not make it valid for longer.
  EXPECT_EQ(watchdog.offer(request(0.5, kWall + 5ms), kWall, kSteady), DriveStatus::kObeyed);
  EXPECT_FALSE(watchdog.command(kSteady + kTimeout).has_value());
}

// A sender's clock may be ahead. If its stamp were kept unchanged, the next command would look
// older.
TEST(DriveWatchdog, AStampAheadOfOurClockDoesNotMakeLaterCommandsOlder) {
  DriveWatchdog watchdog(kTimeout);
  ASSERT_EQ(watchdog.offer(request(0.5, kWall + 5ms), kWall, kSteady), DriveStatus::kObeyed);
  EXPECT_EQ(watchdog.offer(request(0.7, kWall + 1ms), kWall + 1ms, kSteady + 1ms),
            DriveStatus::kObeyed);
  EXPECT_EQ(watchdog.command(kSteady + 1ms)->forward_mps, 0.7);
}

// The robot is driven at 0.5 m/s, 75 times a second. A second sender sends 5 m/s, 100 times a
// second and stamped 4 ms ahead, so that each of its commands looks newer than those of the first.
TEST(DriveWatchdog, TwoSendersAreNotObeyedUntilOneHasEnded) {
  DriveWatchdog watchdog(kTimeout);
  const auto own = [&watchdog](time::SteadyTime now) {
    const time::Timestamp wall = kWall + (now - kSteady);
    return watchdog.offer({{0.5, 0.0}, wall, 1s, kOwn}, wall, now);
  };
  const auto forged = [&watchdog](time::SteadyTime now) {
    const time::Timestamp wall = kWall + (now - kSteady);
    return watchdog.offer({{5.0, 0.0}, wall + 4ms, 1s, kOther}, wall, now);
  };
  time::SteadyTime now = kSteady;
  const auto run_until = [&](time::SteadyTime end, bool is_attacked) {
    for (; now < end; now += 1ms) {
      if ((now - kSteady) % 13ms == 0ms) {
        static_cast<void>(own(now));
      }
      if (is_attacked && (now - kSteady) % 10ms == 5ms) {
        EXPECT_EQ(forged(now), DriveStatus::kOtherSender);
      }
      const auto command = watchdog.command(now);
      EXPECT_TRUE(!command || command->forward_mps == 0.5);
    }
  };
  run_until(kSteady + 1s, false);
  ASSERT_TRUE(watchdog.command(now));
  run_until(kSteady + 1050ms, true);
  EXPECT_FALSE(watchdog.command(now));
  EXPECT_TRUE(watchdog.is_contested(now));
  run_until(kSteady + 3s, true);
  EXPECT_FALSE(watchdog.command(now));
  run_until(kSteady + 4050ms, false);
  EXPECT_FALSE(watchdog.is_contested(now));
  EXPECT_EQ(watchdog.command(now)->forward_mps, 0.5);
}

// Twice a second is too seldom to be worth stopping for, and without effect.
TEST(DriveWatchdog, NoCommandOfASecondSenderIsObeyed) {
  for (const time::Duration pause : {13ms, 520ms}) {
    DriveWatchdog watchdog(kTimeout);
    for (time::SteadyTime now = kSteady; now < kSteady + 10s; now += 13ms) {
      const time::Timestamp wall = kWall + (now - kSteady);
      static_cast<void>(watchdog.offer({{0.5, 0.0}, wall, 1s, kOwn}, wall, now));
      if ((now - kSteady) % pause == 0ms) {
        EXPECT_EQ(watchdog.offer({{5.0, 0.0}, wall, 1s, kOther}, wall, now),
                  DriveStatus::kOtherSender);
      }
      const auto command = watchdog.command(now);
      EXPECT_TRUE(!command || command->forward_mps == 0.5);
      EXPECT_TRUE(command || pause == 13ms) << "two a second stop the robot";
    }
    EXPECT_EQ(watchdog.is_contested(kSteady + 10s), pause == 13ms);
  }
}

// Its clock is behind, so that each of its commands would be refused anyway.
TEST(DriveWatchdog, ASecondSenderIsNoticedByItsStaleCommandsToo) {
  DriveWatchdog watchdog(kTimeout);
  for (time::SteadyTime now = kSteady; now < kSteady + 1s; now += 10ms) {
    const time::Timestamp wall = kWall + (now - kSteady);
    static_cast<void>(watchdog.offer({{0.5, 0.0}, wall, 1s, kOwn}, wall, now));
    static_cast<void>(watchdog.offer({{5.0, 0.0}, wall - 1s, 1s, kOther}, wall, now));
  }
  EXPECT_TRUE(watchdog.is_contested(kSteady + 1s));
  EXPECT_FALSE(watchdog.command(kSteady + 1s));
}

// The driver was frozen for half a second, longer than a sender may be silent. What waited is read
// then, the first of it somebody else's.
TEST(DriveWatchdog, AFrozenDriverGoesOnFollowingItsSender) {
  DriveWatchdog watchdog(kTimeout);
  ASSERT_EQ(watchdog.offer(request(0.5, kWall), kWall, kSteady), DriveStatus::kObeyed);
  static constexpr time::Duration kFrozen = 500ms;
  const auto read = [&watchdog](const bus::Sender& sender, time::Duration sent) {
    return watchdog.offer({{0.5, 0.0}, kWall + sent, 1s, sender, kFrozen - sent}, kWall + kFrozen,
                          kSteady + kFrozen);
  };
  for (time::Duration sent = 10ms; sent <= kFrozen; sent += 10ms) {
    if (sent == 310ms) {
      EXPECT_EQ(read(kOther, sent - 5ms), DriveStatus::kOtherSender);
    }
    EXPECT_EQ(read(kOwn, sent),
              sent <= kFrozen - kTimeout ? DriveStatus::kStale : DriveStatus::kObeyed)
        << sent / 1ms;
  }
}

// It may have been sent ahead of its time, to be obeyed when the driver reads it.
TEST(DriveWatchdog, ADriveFromTheFutureDoesNotBecomeValidWhileItWaits) {
  DriveWatchdog watchdog(kTimeout);
  EXPECT_EQ(watchdog.offer({{0.5, 0.0}, kWall, 1s, kOwn, 10ms}, kWall, kSteady),
            DriveStatus::kFromFuture);
  EXPECT_FALSE(watchdog.command(kSteady));
}

TEST(DriveWatchdog, ARefusedDriveDoesNotKeepTheSenderOut) {
  for (const time::Duration ahead : {45ms, -300ms}) {
    DriveWatchdog watchdog(kTimeout);
    ASSERT_EQ(watchdog.offer(request(0.5, kWall), kWall, kSteady), DriveStatus::kObeyed);
    EXPECT_NE(watchdog.offer({{5.0, 0.0}, kWall + ahead, 1s, kOther}, kWall, kSteady),
              DriveStatus::kObeyed);
    EXPECT_EQ(watchdog.offer(request(0.7, kWall), kWall, kSteady), DriveStatus::kObeyed);
  }
}

TEST(DriveWatchdog, AnImplausibleDriveRevokesThePreviousCommand) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const DriveRequest& nonsense :
       {request(nan, kWall), request(-infinity, kWall), request(11.0, kWall),
        request(0.5, kWall, 0us), request(0.5, kWall, -1us),
        DriveRequest{{0.5, nan}, kWall, 100ms, kOwn}, DriveRequest{{0.5, 19.0}, kWall, 100ms, kOwn},
        request(-11.0, kWall), DriveRequest{{0.5, -19.0}, kWall, 100ms, kOwn}}) {
    DriveWatchdog watchdog(kTimeout);
    ASSERT_EQ(watchdog.offer(request(0.5, kWall), kWall, kSteady), DriveStatus::kObeyed);
    EXPECT_NE(watchdog.offer(nonsense, kWall, kSteady + 1ms), DriveStatus::kObeyed);
    EXPECT_FALSE(watchdog.command(kSteady + 1ms).has_value());
  }
}

TEST(DriveWatchdog, AnOlderCommandDoesNotReplaceANewerValidOne) {
  DriveWatchdog watchdog(kTimeout);
  ASSERT_EQ(watchdog.offer(request(0.5, kWall), kWall, kSteady), DriveStatus::kObeyed);
  EXPECT_EQ(watchdog.offer(request(0.9, kWall - 1ms), kWall, kSteady + 100us),
            DriveStatus::kOutOfOrder);
  EXPECT_EQ(watchdog.command(kSteady + 100us)->forward_mps, 0.5);
  // The wall clock was set back by an hour: after the timeout the order starts again.
  const time::Duration hour = 3600s;
  EXPECT_EQ(watchdog.offer(request(0.7, kWall - hour), kWall - hour, kSteady + kTimeout),
            DriveStatus::kObeyed);
}

TEST(DriveWatchdog, AfterARevocationNothingIsObeyedUntilTheNextDrive) {
  DriveWatchdog watchdog(kTimeout);
  ASSERT_EQ(watchdog.offer(request(0.5, kWall), kWall, kSteady), DriveStatus::kObeyed);
  watchdog.revoke();
  EXPECT_FALSE(watchdog.command(kSteady).has_value());
  ASSERT_EQ(watchdog.offer(request(0.5, kWall + 1us), kWall + 1us, kSteady + 1us),
            DriveStatus::kObeyed);
  EXPECT_TRUE(watchdog.command(kSteady + 1us).has_value());
}

TEST(DriveWatchdog, EveryStatusHasItsName) {
  std::set<std::string> names;
  for (const DriveStatus status :
       {DriveStatus::kObeyed, DriveStatus::kNotFinite, DriveStatus::kImplausible,
        DriveStatus::kStale, DriveStatus::kFromFuture, DriveStatus::kOutOfOrder,
        DriveStatus::kOtherSender}) {
    EXPECT_STRNE(name_of(status), "");
    EXPECT_TRUE(names.insert(name_of(status)).second) << name_of(status);
  }
}

}  // namespace drive_watchdog_test
}  // namespace nodmap::kurt
