// SPDX-License-Identifier: BSD-3-Clause
// The lowest beams meet the floor 15 cm before the robot, a few millimetres apart and so steeply
// that the noise of a range is nearly as much height. The reversals there are short, but a cell
// that was wrongly blocked in one is out of view as soon as the robot has moved a centimetre.
#include <gtest/gtest.h>

#include <random>

#include "modules/navigator/local_map/local_map.hpp"

namespace nodmap::navigator {
namespace steep_beams_test {

using geometry::deg_to_rad;

constexpr double kMountM = 0.38;
constexpr double kRangeSigmaM = 0.01;  // SICK LMS200

// A scan of level floor, which ends 6 m away at a wall.
scan::Scan scan_of_floor(double pitch_rad, std::mt19937& engine) {
  std::normal_distribution<double> noise_m(0.0, kRangeSigmaM);
  scan::Scan scan;
  scan.duration = 6660us;
  scan.angle_first_rad = -0.5 * geometry::kPi;
  scan.angle_step_rad = deg_to_rad(1.0);
  scan.pitch_first_rad = scan.pitch_last_rad = pitch_rad;
  scan.range_min_m = 0.05;
  scan.range_max_m = 80.0;
  scan.T_base_mount.translation() = Eigen::Vector3d(0.15, 0.0, kMountM);
  scan.ranges_m.resize(181);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double down = -scan::beam_direction(scan.angle_rad(i), pitch_rad).z();
    const double range_m = std::min(6.0, kMountM / std::max(1e-6, down));
    scan.ranges_m[i] = static_cast<float>(range_m + noise_m(engine));
  }
  return scan;
}

// A reversal at 60 degrees: 2.1 rad/s, with 40 rad/s². Two beams in two scans, or two side by side,
// must not suffice for a hole or an obstacle if they are within the noise: of these 200 reversals
// four would leave one; six would have one after some scan, when the robot may drive on.
TEST(SteepBeams, TheirNoiseBlocksNothing) {
  constexpr double kScanS = 0.01332;
  constexpr double kRateRadS = 2.1;
  constexpr double kRampS = kRateRadS / 40.0;
  std::mt19937 engine(1);
  for (int run = 0; run < 200; ++run) {
    LocalMap map({}, {});
    for (int i = -9; i <= 9; ++i) {
      const double away_s = kScanS * std::abs(i);
      const double up_rad = away_s < kRampS ? 0.5 * kRateRadS / kRampS * away_s * away_s
                                            : kRateRadS * (away_s - 0.5 * kRampS);
      map.add_scan(scan_of_floor(deg_to_rad(-60.0) + up_rad, engine), {});
      ASSERT_TRUE(map.points_base({}, 1.5).empty()) << run << " " << i;
    }
  }
}

}  // namespace steep_beams_test
}  // namespace nodmap::navigator
