// SPDX-License-Identifier: BSD-3-Clause
// 6D SLAM when a part fails: a sweep is lost, the servo stalls, the wheels slip, the laser is slow.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "common/geometry/angle.hpp"
#include "modules/slam6d/slam6d.hpp"
#include "modules/slam6d/test/room.hpp"

namespace nodmap::slam6d {
namespace faults_test {

using geometry::deg_to_rad;
using geometry::SE3;

// A drive through the hall at 0.3 m/s for five sweeps, with a fault.
class FaultyDrive {
 public:
  static constexpr std::int64_t kScansPerSweep = 80;

  std::int64_t num_scans = 5 * kScansPerSweep;
  std::function<bool(std::int64_t)> is_lost = [](std::int64_t) { return false; };
  // The servo's pitch at a scan is that of this scan of a drive without a fault.
  std::function<std::int64_t(std::int64_t)> pitch_at = [](std::int64_t i) { return i; };
  // The distance (m) that odometry has counted too much at a scan.
  std::function<double(std::int64_t)> counted_too_much_m = [](std::int64_t) { return 0.0; };

  void run(Slam6d& slam) const {
    std::mt19937 random(21);
    const NoddingScanner scanner{.noise_m = 0.01};
    for (std::int64_t i = 0; i < num_scans; ++i) {
      const auto pitch_i = pitch_at(i);
      const time::Duration later = (i - pitch_i) * NoddingScanner::kPeriod;
      const Motion motion = [later](time::Timestamp t) {
        return drive_ahead(kSpeedMps, t + later);
      };
      scan::Scan scan = scanner.scan(pitch_i, Room::hall(), motion, random);
      scan.stamp += later;
      for (const time::Timestamp stamp : {scan.stamp, scan.last_stamp()}) {
        SE3 T_odom_base = drive_ahead(kSpeedMps, stamp);
        T_odom_base.translation().x() += counted_too_much_m(i);
        slam.add_odometry(stamp, T_odom_base);
      }
      if (!is_lost(i)) {
        (void)slam.add_scan(std::move(scan));
      }
    }
    (void)slam.flush();
  }

  // Expects that all tracked poses are right, with tolerances for 1 cm of scan noise, and that the
  // last sweep is tracked.
  static void expect_right(const Slam6d& slam) {
    for (const SweepPose& pose : slam.sweeps()) {
      if (pose.is_tracked) {
        const SE3 error = drive_ahead(kSpeedMps, pose.stamp).inverse() * pose.T_map_base_online;
        EXPECT_LT(error.translation().norm(), 0.015);
        EXPECT_LT(geometry::rotation_angle(error), deg_to_rad(0.2));
      }
    }
    EXPECT_TRUE(slam.sweeps().back().is_tracked);
  }

 private:
  static constexpr double kSpeedMps = 0.3;
};

TEST(Faults, ALostSweepIsBridged) {
  FaultyDrive drive;
  drive.is_lost = [](std::int64_t i) { return i / FaultyDrive::kScansPerSweep == 2; };
  Slam6d slam({});
  drive.run(slam);
  FaultyDrive::expect_right(slam);
  EXPECT_EQ(slam.sweeps().size(), 4U);
  EXPECT_EQ(slam.metrics().sweeps_lost, 0U);
}

// The head stays where it is for 2 s while the robot drives on.
TEST(Faults, AStalledServoDoesNotBendTheMap) {
  static constexpr std::int64_t kStallScan = 200;
  static constexpr std::int64_t kStalledScans = 150;
  FaultyDrive drive;
  drive.num_scans += kStalledScans;
  drive.pitch_at = [](std::int64_t i) {
    return i < kStallScan ? i : std::max(kStallScan, i - kStalledScans);
  };
  Slam6d slam({});
  drive.run(slam);
  FaultyDrive::expect_right(slam);
  EXPECT_EQ(slam.scan_counts().in_sweeps, static_cast<std::size_t>(drive.num_scans));
}

TEST(Faults, OdometryTenPercentOffInOneSweepIsCorrected) {
  constexpr double kDistancePerScanM = 0.3 * 0.01332;
  FaultyDrive drive;
  drive.counted_too_much_m = [](std::int64_t i) {
    const std::int64_t within = std::clamp<std::int64_t>(i - 2 * FaultyDrive::kScansPerSweep, 0,
                                                         FaultyDrive::kScansPerSweep);
    return 0.1 * kDistancePerScanM * static_cast<double>(within);
  };
  Slam6d slam({});
  drive.run(slam);
  FaultyDrive::expect_right(slam);
  EXPECT_EQ(slam.metrics().sweeps_lost, 0U);
}

// A slow laser on a slow head takes 10 scans a second, 1200 from one reversal to the next. No sweep
// may be cut.
TEST(Faults, SweepsOfTwoMinutesAreNotCut) {
  constexpr std::int64_t kScansPerSweep = 1200;
  constexpr std::int64_t kSweeps = 3;
  const NoddingScanner scanner{.step_rad = deg_to_rad(80.0) / static_cast<double>(kScansPerSweep),
                               .noise_m = 0.01};
  const auto stand = [](time::Timestamp) { return SE3::Identity(); };
  std::mt19937 random(22);
  Slam6d slam({});
  std::vector<PoseUpdate> updates;
  for (std::int64_t i = 0; i < kSweeps * kScansPerSweep; ++i) {
    scan::Scan scan = scanner.scan(i, Room::hall(), stand, random);
    scan.stamp = time::Timestamp(i * 100ms);
    slam.add_odometry(scan.stamp, SE3::Identity());
    slam.add_odometry(scan.last_stamp(), SE3::Identity());
    if (const auto update = slam.add_scan(std::move(scan))) {
      updates.push_back(*update);
    }
  }
  updates.push_back(slam.flush().value());
  ASSERT_EQ(updates.size(), static_cast<std::size_t>(kSweeps));
  for (const PoseUpdate& update : updates) {
    // A sweep is cut to within a scan or two of its reversal. The tolerance is the hysteresis of 1
    // degree, which is 15 scans of this head.
    EXPECT_NEAR(static_cast<double>(update.scans_used), static_cast<double>(kScansPerSweep), 16.0);
    EXPECT_TRUE(update.is_tracked());
    EXPECT_LT(update.T_map_base.translation().norm(), 0.005);
    EXPECT_LT(geometry::rotation_angle(update.T_map_base), deg_to_rad(0.3));
  }
}

// Somebody holds the robot: from the third sweep on its wheels count 0.3 m/s while it is
// stationary. What is wrong is the motion within each sweep, not only where the sweep begins.
TEST(Faults, WheelsThatSpinAllTheTimeDoNotKeepTheRobotLost) {
  constexpr std::int64_t kStationaryScans = 2 * FaultyDrive::kScansPerSweep;
  const NoddingScanner scanner{.noise_m = 0.01};
  const auto stand = [](time::Timestamp) { return SE3::Identity(); };
  // Small, so that all of it is seen: along a corridor odometry would rightly be believed.
  const Room chamber{{{{0, 0, 1}, 0.0},
                      {{0, 0, 1}, 2.5},
                      {{0, 1, 0}, 1.6},
                      {{0, 1, 0}, -1.4},
                      {{1, 0, 0}, 2.2},
                      {{1, 0, 0}, -2.0}}};
  std::mt19937 random(23);
  Slam6d slam({});
  std::vector<PoseUpdate> updates;
  for (std::int64_t i = 0; i < 12 * FaultyDrive::kScansPerSweep; ++i) {
    scan::Scan scan = scanner.scan(i, chamber, stand, random);
    for (const time::Timestamp stamp : {scan.stamp, scan.last_stamp()}) {
      const time::Duration spinning =
          stamp - time::Timestamp(kStationaryScans * NoddingScanner::kPeriod);
      slam.add_odometry(stamp,
                        drive_ahead(0.3, time::Timestamp(std::max(time::Duration{}, spinning))));
    }
    if (const auto update = slam.add_scan(std::move(scan))) {
      updates.push_back(*update);
    }
  }
  ASSERT_GE(updates.size(), 11U);
  // Each refused sweep doubles the deviation that is possible, so the fourth is accepted.
  bool is_found = false;
  for (std::size_t k = 2; k < 6; ++k) {
    is_found = is_found || updates[k].is_tracked();
  }
  EXPECT_TRUE(is_found);
  for (const PoseUpdate& update : updates) {
    if (update.is_tracked()) {
      EXPECT_LT(update.T_map_base.translation().norm(), 0.05);
    }
  }
}

}  // namespace faults_test
}  // namespace nodmap::slam6d
