// SPDX-License-Identifier: BSD-3-Clause
// A robot that maps a bare corridor for the first time. Only odometry determines its way along the
// corridor, so this way must be that of odometry, which is exact here.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

#include "modules/slam6d/slam6d.hpp"
#include "modules/slam6d/test/room.hpp"

namespace nodmap::slam6d {
namespace corridor_test {

using geometry::SE3;

constexpr std::int64_t kScansPerSweep = 80;
constexpr double kSpeedMps = 0.6;  // 0.64 m in each sweep

class Robot {
 public:
  // Takes sweeps, with the laser looking ahead.
  void add_sweeps(std::int64_t num_sweeps, double speed_mps) {
    for (std::int64_t i = 0; i < num_sweeps * kScansPerSweep; ++i, ++index_) {
      const SE3 T_world_start = T_world_base_;
      const time::Timestamp start(index_ * NoddingScanner::kPeriod);
      const Motion motion = [&](time::Timestamp stamp) {
        SE3 T_world_base = T_world_start;
        T_world_base.translation().x() += speed_mps * time::seconds(stamp - start);
        return T_world_base;
      };
      scan::Scan scan = scanner_.scan(index_, Room::corridor(), motion, random_);
      T_world_base_ = motion(start + NoddingScanner::kPeriod);
      for (const time::Timestamp stamp : {scan.stamp, scan.last_stamp()}) {
        slam_.add_odometry(stamp + gap_, motion(stamp));
      }
      scan.stamp += gap_;
      (void)slam_.add_scan(std::move(scan));
    }
  }

  void pause(time::Duration duration) { gap_ += duration; }

  // Expects that the newest pose is where odometry says, with at most this uncertainty.
  void expect_at_odometry(double max_error_m, double max_sigma_m) {
    const auto update = slam_.flush();
    ASSERT_TRUE(update && update->is_tracked());
    EXPECT_LT(
        std::abs(update->T_map_base.translation().x() - update->T_odom_base.translation().x()),
        max_error_m);
    EXPECT_LT(std::sqrt(update->covariance(0, 0)), max_sigma_m);
  }

 private:
  Slam6d slam_{{}};
  NoddingScanner scanner_{.noise_m = 0.01};
  std::mt19937 random_{31};
  SE3 T_world_base_ = SE3::Identity();
  std::int64_t index_ = 0;
  time::Duration gap_{};
};

// An interruption leaves 0.3 m of uncertainty (odometry.interruption_m), and a stationary
// robot adds next to nothing to it.
TEST(Corridor, AStationaryRobotStaysAfterAnInterruption) {
  Robot robot;
  robot.add_sweeps(7, kSpeedMps);
  robot.pause(2s);
  robot.add_sweeps(30, 0.0);
  robot.expect_at_odometry(0.05, 0.35);
}

// 26 m; a hundredth of it is what the noise of walls may pull along a corridor.
TEST(Corridor, ADriveAfterAnInterruptionIsAsLongAsOdometrySays) {
  Robot robot;
  robot.add_sweeps(7, kSpeedMps);
  robot.pause(2s);
  robot.add_sweeps(40, kSpeedMps);
  robot.expect_at_odometry(0.3, 0.6);
}

}  // namespace corridor_test
}  // namespace nodmap::slam6d
