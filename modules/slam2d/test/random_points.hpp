// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "common/geometry/angle.hpp"
#include "modules/slam2d/scan/oriented_points.hpp"

namespace nodmap::slam2d::test {

/// Points in a square around the origin with random normals, a fifth of them without.
inline std::vector<OrientedPoint> random_points(int count, unsigned seed, double half_size_m) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-half_size_m, half_size_m);
  std::uniform_real_distribution<double> angle(-geometry::kPi, geometry::kPi);
  std::vector<OrientedPoint> points;
  for (int i = 0; i < count; ++i) {
    const double a = angle(random);
    const Eigen::Vector2d normal(std::cos(a), std::sin(a));
    points.push_back(
        {{coordinate(random), coordinate(random)}, i % 5 == 0 ? Eigen::Vector2d::Zero() : normal});
  }
  return points;
}

}  // namespace nodmap::slam2d::test
