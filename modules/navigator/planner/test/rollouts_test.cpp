// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/rollouts.hpp"

#include <gtest/gtest.h>

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
  Rollouts rollouts(kBody, {}, {});
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

// In a corridor of 0.7 m the corners of the body keep 7 cm: it can turn there, though the paths
// ahead keep 6 cm and the measured clearance is up to 3.5 cm too small.
TEST(Rollouts, TurnsRoundInADeadEnd) {
  PlannerParams params;
  GlobalPlanner planner(kBody, params);
  const LocalMap nothing({}, {});
  for (int i = 0; i < 400 && planner.cost_to_go() == nullptr; ++i) {
    planner.step(13'320 * i, nothing, {}, {}, {-4.0, 0.0}, 0.2);
  }
  ASSERT_NE(planner.cost_to_go(), nullptr);
  Situation now;
  for (double x = -2.0; x < 0.5; x += 0.01) {
    now.points_base.emplace_back(x, 0.35);
    now.points_base.emplace_back(x, -0.35);
  }
  for (double y = -0.35; y < 0.35; y += 0.01) {
    now.points_base.emplace_back(0.5, y);
  }
  Rollouts rollouts(kBody, params, {});
  const auto& found = rollouts.plan(now, *planner.cost_to_go(), 1.0);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found.front().forward_mps, 0.0);
  EXPECT_NEAR(std::abs(found.front().yaw_rate_rad_s), params.rotation_rad_s,
              0.26 * params.rotation_rad_s)
      << "one of the two fastest rates";
}

}  // namespace
}  // namespace nodmap::navigator
