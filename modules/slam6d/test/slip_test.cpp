// SPDX-License-Identifier: BSD-3-Clause
// A robot drives at an obstacle that no beam shows, and its wheels go on turning.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "modules/slam6d/slam6d.hpp"
#include "modules/slam6d/test/room.hpp"

namespace nodmap::slam6d {
namespace slip_test {

using geometry::SE3;

constexpr std::int64_t kScansPerSweep = 80;
constexpr double kSpeedMps = 0.5;  // 0.53 m in each sweep

// The sweeps are numbered from 0. From the beginning of sweep `slips_from` until that of
// `slips_to` the wheels turn in vain, apart from this share of the motion that they count.
struct PushingDrive {
  Room room = Room::hall();
  double slips_from = 4.0;
  double slips_to = 6.0;
  double share = 0.0;

  [[nodiscard]] static double drives_for_s(double sweeps) {
    return sweeps * time::seconds(kScansPerSweep * NoddingScanner::kPeriod);
  }

  [[nodiscard]] SE3 truth(time::Timestamp stamp) const {
    const double t = time::seconds(stamp.time_since_epoch());
    const double slipped_s = std::clamp(t - drives_for_s(slips_from), 0.0,
                                        drives_for_s(slips_to) - drives_for_s(slips_from));
    SE3 T_world_base = SE3::Identity();
    T_world_base.translation().x() = kSpeedMps * (t - (1.0 - share) * slipped_s);
    return T_world_base;
  }

  [[nodiscard]] std::vector<PoseUpdate> run(Slam6d& slam, std::int64_t num_sweeps) const {
    const NoddingScanner scanner{.noise_m = 0.01};
    const Motion motion = [this](time::Timestamp stamp) { return truth(stamp); };
    std::mt19937 random(41);
    std::vector<PoseUpdate> updates;
    for (std::int64_t i = 0; i < num_sweeps * kScansPerSweep; ++i) {
      scan::Scan scan = scanner.scan(i, room, motion, random);
      for (const time::Timestamp stamp : {scan.stamp, scan.last_stamp()}) {
        slam.add_odometry(stamp, drive_ahead(kSpeedMps, stamp));
      }
      if (const auto update = slam.add_scan(std::move(scan))) {
        updates.push_back(*update);
      }
    }
    return updates;
  }

  [[nodiscard]] double error_m(const PoseUpdate& update) const {
    return geometry::distance_m(truth(update.stamp), update.T_map_base);
  }

  // Every pose but LOST ones is right within 2 cm, as is the last one.
  void expect_right(const std::vector<PoseUpdate>& updates) const {
    for (const PoseUpdate& update : updates) {
      EXPECT_TRUE(!update.is_tracked() || error_m(update) < 0.02)
          << "sweep " << &update - updates.data() << " is off by " << error_m(update) << " m";
    }
    EXPECT_TRUE(updates.back().is_tracked());
  }
};

// The end wall of the hall is where it was.
TEST(Slip, WheelsThatTurnInVainDoNotCarryThePoseAlong) {
  const PushingDrive drive;
  Slam6d slam({});
  const std::vector<PoseUpdate> updates = drive.run(slam, 9);
  drive.expect_right(updates);
  EXPECT_TRUE(updates[4].registration->is_slipped);
}

TEST(Slip, HalfOfTheCountedMotionIsFound) {
  const PushingDrive drive{.share = 0.5};
  Slam6d slam({});
  drive.expect_right(drive.run(slam, 9));
}

// What was seen while the wheels slipped enters neither the map nor the calibration of the wheels.
TEST(Slip, NothingIsLearnedFromASlippedSweep) {
  const PushingDrive drive;
  Slam6d slam({});
  const std::vector<PoseUpdate> before = drive.run(slam, 5);
  ASSERT_EQ(before.size(), 4U);
  const std::size_t voxels = slam.map().level(0).voxels().size();
  Slam6d longer({});
  const std::vector<PoseUpdate> updates = drive.run(longer, 6);
  ASSERT_TRUE(updates[4].registration->is_slipped);
  EXPECT_EQ(longer.map().level(0).voxels().size(), voxels);
  EXPECT_EQ(longer.calibration().errors(), slam.calibration().errors());
}

// Nothing shows how far the robot has come, so its pose must not claim to know.
TEST(Slip, InABareCorridorThePoseIsDegraded) {
  const PushingDrive drive{.room = Room::corridor()};
  Slam6d slam({});
  const std::vector<PoseUpdate> updates = drive.run(slam, 9);
  for (std::size_t k = 4; k < updates.size(); ++k) {
    EXPECT_NE(updates[k].registration->state, PoseState::kTracking);
  }
}

}  // namespace slip_test
}  // namespace nodmap::slam6d
