// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/body_clearance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "common/robot/robot_params.hpp"
#include "modules/navigator/behaviours/corridor.hpp"

namespace nodmap::navigator {
namespace body_clearance_test {

const robot::Footprint kBody = robot::Body{}.footprint();

// Oracle: the signed distance of a point from the body at a pose, by the definition of a
// rectangle.
double distance_m(const Eigen::Vector2d& p, const geometry::SE2& pose,
                  const robot::Footprint& body = kBody) {
  const Eigen::Vector2d q = pose.inverse() * p;
  const double dx = std::abs(q.x()) - body.half_length_m;
  const double dy = std::abs(q.y()) - body.half_width_m;
  return std::max(dx, dy) < 0.0 ? std::max(dx, dy)
                                : std::hypot(std::max(dx, 0.0), std::max(dy, 0.0));
}

// Clearance is exact near the body and near the robot. Elsewhere a cell of 2.5 cm stands for any
// point in it, an error of up to 1.8 cm; and the discs that cover the body leave out up to 1.1 cm
// between them, which counts as clearance.
TEST(BodyClearance, IsThatOfTheRectangle) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place_m(-1.0, 1.0);
  std::uniform_real_distribution<double> yaw_rad(-3.1, 3.1);
  BodyClearance clearance(kBody);
  int near = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector2d p(place_m(random), place_m(random));
    const geometry::SE2 pose{0.3 * place_m(random), 0.3 * place_m(random), yaw_rad(random)};
    const double truth_m = distance_m(p, pose);
    if (is_error_of_map(p, kBody) || truth_m > 0.4) {
      continue;
    }
    clearance.measure({p});
    EXPECT_NEAR(clearance.at(pose), truth_m, truth_m < 0.06 ? 1e-9 : 0.035);
    near += truth_m < 0.06;
  }
  EXPECT_GT(near, 100);
}

// The same for bodies that are much longer than wide, or wider than long.
TEST(BodyClearance, IsThatOfALongRectangle) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  for (const Eigen::Vector2d& size_m :
       {Eigen::Vector2d(1.0, 0.4), {1.5, 0.4}, Eigen::Vector2d(0.4, 1.0)}) {
    const robot::Footprint body{0.5 * size_m.x(), 0.5 * size_m.y()};
    BodyClearance clearance(body);
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector2d p(share(random) * (body.half_length_m + 0.2),
                              share(random) * (body.half_width_m + 0.2));
      if (is_error_of_map(p, body)) {
        continue;
      }
      clearance.measure({p});
      const double truth_m = distance_m(p, {}, body);
      EXPECT_NEAR(clearance.at({}), truth_m, truth_m < 0.06 ? 1e-9 : 0.035)
          << size_m.transpose() << ": " << p.transpose();
    }
  }
}

}  // namespace body_clearance_test
}  // namespace nodmap::navigator
