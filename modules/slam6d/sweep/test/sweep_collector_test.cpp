// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/sweep/sweep_collector.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "modules/slam6d/test/room.hpp"

namespace nodmap::slam6d {
namespace sweep_collector_test {

using geometry::SE3;

constexpr double kSpeedMps = 1.0;
constexpr std::int64_t kScansPerSweep = 80;  // 1.07 s

// A drive ahead through the hall. A scan is received when it is complete, odometry when it is
// measured.
class Drive {
 public:
  explicit Drive(time::Duration odometry_period) : odometry_period_(odometry_period) {}

  // The scans up to (without) number `end`, and the odometry that is received before each.
  void run_to(std::int64_t end) {
    const NoddingScanner scanner;
    const Motion motion = [](time::Timestamp stamp) { return drive_ahead(kSpeedMps, stamp); };
    for (; next_scan_ < end; ++next_scan_) {
      scan::Scan scan = scanner.scan(next_scan_, Room::hall(), motion, random_);
      for (; has_odometry && next_odometry_ <= scan.last_stamp();
           next_odometry_ += odometry_period_) {
        EXPECT_TRUE(collector.add_odometry(next_odometry_, motion(next_odometry_)));
      }
      const time::Timestamp received = scan.last_stamp();
      if (auto sweep = collector.add_scan(std::move(scan))) {
        sweeps.push_back(std::move(*sweep));
        delays.push_back(received - sweeps.back().scans.back().scan.last_stamp());
      }
    }
  }

  // The same scans, but the odometry that would be received with them is lost.
  void run_without_odometry_to(std::int64_t end) {
    has_odometry = false;
    run_to(end);
    has_odometry = true;
    while (next_odometry_ < time::Timestamp(end * NoddingScanner::kPeriod)) {
      next_odometry_ += odometry_period_;
    }
  }

  void flush() {
    while (auto sweep = collector.flush()) {
      sweeps.push_back(std::move(*sweep));
    }
  }

  SweepCollector collector{{}, false};
  bool has_odometry = true;
  std::vector<PlacedSweep> sweeps;
  std::vector<time::Duration> delays;  // of each, from its end until it was returned

 private:
  time::Duration odometry_period_;
  std::int64_t next_scan_ = 0;
  time::Timestamp next_odometry_{};
  std::mt19937 random_{1};
};

// At a steady speed interpolation and extrapolation are exact.
void expect_right_poses(const PlacedSweep& sweep) {
  EXPECT_EQ(sweep.scans_without_pose, 0U);
  for (const PlacedSweep::PlacedScan& placed : sweep.scans) {
    const SE3 T_odom_first = drive_ahead(kSpeedMps, placed.scan.stamp);
    EXPECT_TRUE(placed.T_odom_first.isApprox(T_odom_first, 1e-9));
    const SE3 T_odom_last = drive_ahead(kSpeedMps, placed.scan.last_stamp());
    EXPECT_TRUE(placed.T_odom_last.isApprox(T_odom_last, 1e-9));
  }
}

TEST(SweepCollector, AllScansHaveAPoseHoweverSeldomOdometryComes) {
  for (const time::Duration period : {10ms, 20ms, 50ms, 100ms, 200ms, 300ms}) {
    Drive drive(period);
    drive.run_to(6 * kScansPerSweep + 40);
    ASSERT_EQ(drive.sweeps.size(), 6U) << time::seconds(period);
    for (const PlacedSweep& sweep : drive.sweeps) {
      expect_right_poses(sweep);
    }
    EXPECT_EQ(drive.collector.counts().without_pose, 0U);
  }
}

// The head has come back from the reversal by 1 degree, which is a scan of this head, and by half
// of the next one's pitch.
TEST(SweepCollector, WithFrequentOdometryNoSweepWaits) {
  for (const time::Duration period : {10ms, 50ms}) {
    Drive drive(period);
    drive.run_to(4 * kScansPerSweep);
    for (const time::Duration delay : drive.delays) {
      EXPECT_LE(delay, 2 * NoddingScanner::kPeriod);
    }
  }
}

TEST(SweepCollector, ASweepWaitsNoLongerThanHalfASecondForOdometryThatHasStopped) {
  Drive drive(10ms);
  drive.run_to(kScansPerSweep + 40);  // the first sweep and half of the second
  ASSERT_EQ(drive.sweeps.size(), 1U);
  drive.has_odometry = false;
  drive.run_to(2 * kScansPerSweep + 35);
  EXPECT_EQ(drive.sweeps.size(), 1U);
  drive.run_to(2 * kScansPerSweep + 40);  // 0.53 s
  ASSERT_EQ(drive.sweeps.size(), 2U);
  // Half of the second sweep has poses: up to 50 ms, less than four scans, after the last odometry.
  EXPECT_NEAR(static_cast<double>(drive.sweeps.back().scans_without_pose), 40.0 - 4.0, 2.0);
  EXPECT_EQ(drive.collector.counts().without_pose, drive.sweeps.back().scans_without_pose);
  drive.run_to(4 * kScansPerSweep);
  EXPECT_EQ(drive.sweeps.size(), 2U);  // a whole sweep without odometry
  EXPECT_GE(drive.collector.counts().without_pose, 36U + kScansPerSweep);
}

// Odometry is missing from the middle of the third sweep to the middle of the sixth. At a steady
// speed an interpolation would be exact, but a robot drives as it likes.
TEST(SweepCollector, NoScanIsPlacedWhereOdometryWasMissing) {
  Drive drive(20ms);
  drive.run_to(2 * kScansPerSweep + 40);
  drive.run_without_odometry_to(5 * kScansPerSweep + 40);
  drive.run_to(8 * kScansPerSweep + 40);
  std::vector<bool> follow_interruptions;
  for (const PlacedSweep& sweep : drive.sweeps) {
    follow_interruptions.push_back(sweep.follows_interruption);
  }
  // Two whole sweeps, half of the third, and two whole ones.
  EXPECT_EQ(follow_interruptions, (std::vector<bool>{false, false, true, true, false, false}));
  // Extrapolated by up to 50 ms.
  EXPECT_NEAR(static_cast<double>(drive.collector.counts().without_pose),
              3.0 * kScansPerSweep - 4.0, 4.0);
}

// The sweep that waits comes before the unfinished one.
TEST(SweepCollector, AtTheEndNoSweepThatWaitsIsLost) {
  Drive drive(10ms);
  drive.run_to(kScansPerSweep - 10);
  drive.has_odometry = false;
  drive.run_to(kScansPerSweep + 10);
  ASSERT_TRUE(drive.sweeps.empty());
  const time::Timestamp end((kScansPerSweep + 10) * NoddingScanner::kPeriod);
  EXPECT_TRUE(drive.collector.add_odometry(end, drive_ahead(kSpeedMps, end)));
  drive.flush();
  ASSERT_EQ(drive.sweeps.size(), 2U);
  for (const PlacedSweep& sweep : drive.sweeps) {
    expect_right_poses(sweep);
  }
  EXPECT_EQ(drive.sweeps.front().scans.size() + drive.sweeps.back().scans.size(), 90U);
}

}  // namespace sweep_collector_test
}  // namespace nodmap::slam6d
