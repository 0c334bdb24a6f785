// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/grid/ray_walk.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace nodmap::slam2d {
namespace ray_walk_test {

constexpr int kSide = 1000;  // cells of a grid

struct Ray {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
};

// Random rays. Some of them run along an axis, some begin and end at corners of cells, and some
// are so short that they hardly leave their first cell.
std::vector<Ray> rays() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(0.0, kSide);
  std::uniform_int_distribution<int> kind(0, 5);
  std::vector<Ray> rays;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector2d from(coordinate(random), coordinate(random));
    const Eigen::Vector2d to(coordinate(random), coordinate(random));
    switch (kind(random)) {
      case 0:
        rays.push_back({from, {to.x(), from.y()}});
        break;
      case 1:
        rays.push_back({from, {from.x(), to.y()}});
        break;
      case 2:
        rays.push_back({from.array().floor(), to.array().floor()});
        break;
      case 3:
        rays.push_back({from, from + 0.01 * (to - from)});
        break;
      default:
        rays.push_back({from, to});
    }
  }
  return rays;
}

// The oracle: the grid lines that a ray crosses (true for those across x), each computed
// independently from its distance along the ray.
std::vector<bool> lines_crossed(const Ray& ray) {
  constexpr std::int64_t kCell = 1 << 16;
  const auto units = [](double cells) {
    return 2 * static_cast<std::int64_t>(std::floor(cells * kCell / 2)) + 1;
  };
  struct Axis {
    std::int64_t length;
    std::vector<std::int64_t> lines;  // distances from the origin
  };
  const auto axis = [&](double from, double to) {
    Axis found{std::abs(units(to) - units(from)), {}};
    for (std::int64_t line = 0; line <= kSide * kCell; line += kCell) {
      if ((line > units(from)) != (line > units(to))) {
        found.lines.push_back(std::abs(line - units(from)));
      }
    }
    std::sort(found.lines.begin(), found.lines.end());
    return found;
  };
  const Axis x = axis(ray.from.x(), ray.to.x());
  const Axis y = axis(ray.from.y(), ray.to.y());
  std::vector<bool> crossed;
  for (std::size_t i = 0, k = 0; i < x.lines.size() || k < y.lines.size();) {
    const bool along_x = k == y.lines.size() ||
                         (i < x.lines.size() && x.lines[i] * y.length < y.lines[k] * x.length);
    crossed.push_back(along_x);
    ++(along_x ? i : k);
  }
  return crossed;
}

TEST(RayWalk, VisitsTheCellsBetweenTheGridLinesThatTheRayCrosses) {
  for (const Ray& ray : rays()) {
    RayWalk walk(ray.from, ray.to);
    Eigen::Vector2i cell = walk.first_cell();
    EXPECT_EQ(cell, ray.from.array().floor().cast<int>().matrix());
    EXPECT_EQ(walk.last_cell(), ray.to.array().floor().cast<int>().matrix());
    std::vector<std::size_t> expected;
    for (const bool along_x : lines_crossed(ray)) {
      expected.push_back(static_cast<std::size_t>(cell.y() * kSide + cell.x()));
      (along_x ? cell.x() : cell.y()) += along_x ? walk.direction().x() : walk.direction().y();
    }
    EXPECT_EQ(cell, walk.last_cell());
    std::vector<std::size_t> visited;
    walk.advance(static_cast<int>(expected.size()),
                 walk.first_cell().y() * kSide + walk.first_cell().x(), kSide,
                 [&](std::size_t place) { visited.push_back(place); });
    EXPECT_EQ(visited, expected);
  }
}

// The walk advances in strides; each ends at a border that is a random number of cells away.
TEST(RayWalk, CountsTheGridLinesUntilABorder) {
  std::mt19937 random(2);
  std::uniform_int_distribution<int> size(1, 128);
  for (const Ray& ray : rays()) {
    RayWalk walk(ray.from, ray.to);
    const std::vector<bool> lines = lines_crossed(ray);
    for (std::size_t at = 0; at < lines.size();) {
      const Eigen::Vector2i until(size(random), size(random));
      const Eigen::Vector2i crossed = walk.crossings_until(until);
      Eigen::Vector2i expected(0, 0);
      for (; at < lines.size() && (expected.array() < until.array()).all(); ++at) {
        ++(lines[at] ? expected.x() : expected.y());
      }
      if (at == lines.size() && (expected.array() < until.array()).all()) {
        EXPECT_GT(crossed.sum(), expected.sum());  // the ray ends before
        break;
      }
      EXPECT_EQ(crossed, expected);
      walk.advance(crossed.sum(), 0, kSide, [](std::size_t) {});
    }
  }
}

}  // namespace ray_walk_test
}  // namespace nodmap::slam2d
