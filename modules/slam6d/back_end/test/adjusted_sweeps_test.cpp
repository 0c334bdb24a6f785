// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/adjusted_sweeps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "modules/slam6d/slam6d.hpp"
#include "modules/slam6d/test/hall.hpp"

namespace nodmap::slam6d {
namespace adjusted_sweeps_test {

using geometry::SE3;

// Returns the RMS error of the positions of 25 sweeps in a hall, 0.4 m apart, with noisy ranges and
// odometry.
double adjusted_error_mm(unsigned seed, const AdjustmentParams& adjustment) {
  const Room room = slanting_hall();
  std::mt19937 random(seed);
  std::normal_distribution<double> any;
  Slam6d slam({.adjustment = adjustment});
  SE3 T_odom_base = pose(-5.0, 0.0, 0.0);
  std::vector<SE3> truth;
  for (unsigned k = 0; k < 25; ++k) {
    truth.push_back(pose(-5.0 + 0.4 * k, 0.2 * std::sin(0.4 * k), 3.0 * std::cos(0.4 * k)));
    if (k > 0) {
      T_odom_base = T_odom_base * truth[k - 1].inverse() * truth[k] *
                    pose(0.01 * any(random), 0.01 * any(random), 0.3 * any(random));
    }
    SweepCloud cloud = cloud_at(room, truth[k], 1000 * seed + k);
    cloud.T_odom_base = T_odom_base;
    cloud.scans_used = 41;
    (void)slam.add_cloud(std::move(cloud));
  }
  slam.polish();
  const std::vector<SE3> trajectory = slam.trajectory();
  double square_sum_m2 = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    square_sum_m2 += (truth[k].translation() -
                      (truth[0] * trajectory[0].inverse() * trajectory[k]).translation())
                         .squaredNorm();
  }
  return 1e3 * std::sqrt(square_sum_m2 / static_cast<double>(truth.size()));
}

// Two of three sweeps lie between keyframes. Measured: adjusting them as well reduces the error by
// 27 % over three drives.
TEST(AdjustedSweeps, SweepsBetweenKeyframesAreAdjustedAsWell) {
  double with_mm = 0.0;
  double without_mm = 0.0;
  for (const unsigned seed : {1U, 2U, 3U}) {
    with_mm += adjusted_error_mm(seed, {});
    without_mm += adjusted_error_mm(seed, {.sweep_distance_m = 1000.0});
  }
  EXPECT_LT(with_mm, 0.9 * without_mm);
}

}  // namespace adjusted_sweeps_test
}  // namespace nodmap::slam6d
