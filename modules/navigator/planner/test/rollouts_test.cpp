// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/rollouts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace nodmap::navigator {
namespace {

const robot::Footprint kBody = robot::Body{}.footprint();

/// Signed distance of a point from the body at a pose, by the definition of a rectangle.
double distance_m(const Eigen::Vector2d& p, const geometry::SE2& pose) {
  const Eigen::Vector2d q = pose.inverse() * p;
  const double dx = std::abs(q.x()) - kBody.half_length_m;
  const double dy = std::abs(q.y()) - kBody.half_width_m;
  return std::max(dx, dy) < 0.0 ? std::max(dx, dy)
                                : std::hypot(std::max(dx, 0.0), std::max(dy, 0.0));
}

// A cell of 2.5 cm stands for any point in it: 1.8 cm. Between its discs the cover of the body
// leaves 1.1 cm, which is counted as clearance that is not there.
TEST(Rollouts, ClearanceIsThatOfTheRectangle) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place_m(-1.0, 1.0);
  std::uniform_real_distribution<double> yaw_rad(-3.1, 3.1);
  Rollouts rollouts(kBody, {});
  int near = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector2d p(place_m(random), place_m(random));
    const geometry::SE2 pose{0.3 * place_m(random), 0.3 * place_m(random), yaw_rad(random)};
    const double truth_m = distance_m(p, pose);
    if (kBody.grown(-0.03, -0.03).contains(p) || truth_m > 0.4) {
      continue;
    }
    rollouts.measure_clearance({p});
    if (truth_m >= 0.0) {
      EXPECT_NEAR(rollouts.clearance_m(pose), truth_m, 0.035);
      ++near;
    } else {
      EXPECT_LT(rollouts.clearance_m(pose), 0.03);
    }
  }
  EXPECT_GT(near, 500);
}

// Walls 4.75 cm beside the body on both sides, by cells 3.5 cm: less than the 6 cm of fast
// rollouts, more than the 3 cm of those that creep. In the open nothing forbids to be fast.
TEST(Rollouts, PassANarrowPlaceOnlyCreeping) {
  GlobalPlanner planner(kBody, {});
  for (int i = 0; i < 400 && planner.cost_to_go() == nullptr; ++i) {
    planner.step(13'320 * i, LocalMap({}, {}), {}, {}, {6.0, 0.0}, 0.2);
  }
  ASSERT_NE(planner.cost_to_go(), nullptr);
  Rollouts rollouts(kBody, {});
  Situation now;
  const auto fastest_mps = [&] {
    double fastest = 0.0;
    for (const Rollout& rollout : rollouts.plan(now, *planner.cost_to_go(), 1.0)) {
      fastest = std::max(fastest, rollout.forward_mps);
    }
    return fastest;
  };
  EXPECT_EQ(fastest_mps(), 1.0);
  for (double x = 0.3; x < 2.4; x += 0.02) {
    now.points_base.emplace_back(x, kBody.half_width_m + 0.0475);
    now.points_base.emplace_back(x, -kBody.half_width_m - 0.0475);
  }
  EXPECT_GT(fastest_mps(), 0.0);
  EXPECT_LE(fastest_mps(), DriveParams{}.creep_mps);
}

}  // namespace
}  // namespace nodmap::navigator
