// SPDX-License-Identifier: BSD-3-Clause
// Floor plans that consist of straight walls, and a simulated level SICK scanner at the centre of
// the robot.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "common/scan/scan.hpp"
#include "modules/slam2d/grid/occupancy_grid.hpp"
#include "modules/slam2d/scan/oriented_points.hpp"

namespace nodmap::slam2d::test {

struct Wall {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
};
using FloorPlan = std::vector<Wall>;

/// An 8 m x 6 m room with a pillar and a niche: no two corners alike.
inline FloorPlan room() {
  return {{{-3, -2}, {5, -2}},      {{5, -2}, {5, 4}},        {{5, 4}, {1, 4}},
          {{1, 4}, {1, 3}},         {{1, 3}, {-3, 3}},        {{-3, 3}, {-3, -2}},
          {{2.0, 1.0}, {2.6, 1.2}}, {{2.6, 1.2}, {2.4, 1.8}}, {{2.4, 1.8}, {2.0, 1.0}}};
}

/// Two parallel walls 2 m apart, too long for their ends to be seen.
inline FloorPlan corridor() {
  return {{{-200, -1}, {200, -1}}, {{-200, 1}, {200, 1}}};
}

/// A corridor 2.2 m wide from x = -1 m to x = 29 m. Both walls have doors, set back by 12 cm and
/// not opposite each other.
inline FloorPlan corridor_with_doors() {
  FloorPlan plan{{{-1, -1.1}, {-1, 1.1}}, {{29, 1.1}, {29, -1.1}}};
  for (const double side : {1.0, -1.0}) {
    double x = -1.0;
    for (double door = side > 0.0 ? 1.3 : 0.4; door < 28.0; door += 3.6) {
      plan.push_back({{x, 1.1 * side}, {door, 1.1 * side}});
      plan.push_back({{door, 1.1 * side}, {door, 1.22 * side}});
      plan.push_back({{door, 1.22 * side}, {door + 1.0, 1.22 * side}});
      plan.push_back({{door + 1.0, 1.22 * side}, {door + 1.0, 1.1 * side}});
      x = door + 1.0;
    }
    plan.push_back({{x, 1.1 * side}, {29, 1.1 * side}});
  }
  return plan;
}

/// A corridor 2 m wide around a block of 12 m x 8 m. Its centre line is a rectangle of 48 m from
/// the origin to (14, 10).
inline FloorPlan ring_corridor() {
  return {{{-1, -1}, {15, -1}}, {{15, -1}, {15, 11}}, {{15, 11}, {-1, 11}}, {{-1, 11}, {-1, -1}},
          {{1, 1}, {13, 1}},    {{13, 1}, {13, 9}},   {{13, 9}, {1, 9}},    {{1, 9}, {1, 1}}};
}

inline double range_to(const Wall& wall, const Eigen::Vector2d& sensor_origin,
                       const Eigen::Vector2d& ray) {
  const Eigen::Vector2d along = wall.to - wall.from;
  const double det = ray.x() * along.y() - ray.y() * along.x();
  const Eigen::Vector2d d = wall.from - sensor_origin;
  const double range = (d.x() * along.y() - d.y() * along.x()) / det;
  const double position = (d.x() * ray.y() - d.y() * ray.x()) / det;
  return range > 0.0 && position >= 0.0 && position <= 1.0
             ? range
             : std::numeric_limits<double>::infinity();
}

/// Simulates scans of 181 beams over 180 degrees, as in the paper, with the range noise of a SICK.
class Scanner {
 public:
  explicit Scanner(double noise_m = 0.01) : noise_(0.0, noise_m) {}

  scan::Scan scan(const FloorPlan& plan, const geometry::SE2& T_world_base,
                  time::Timestamp stamp = {}) {
    scan::Scan scan;
    scan.stamp = stamp;
    scan.angle_first_rad = -geometry::kPi / 2;
    scan.angle_step_rad = geometry::deg_to_rad(1.0);
    scan.range_min_m = 0.05;
    scan.range_max_m = 30.0;
    for (std::size_t beam = 0; beam < 181; ++beam) {
      const double angle = T_world_base.yaw + scan.angle_rad(beam);
      double range = std::numeric_limits<double>::infinity();
      for (const Wall& wall : plan) {
        range = std::min(
            range, range_to(wall, T_world_base.translation(), {std::cos(angle), std::sin(angle)}));
      }
      range = range > scan.range_max_m ? std::numeric_limits<double>::infinity() : range + noise();
      scan.ranges_m.push_back(static_cast<float>(range));
    }
    return scan;
  }

 private:
  double noise() { return noise_.stddev() > 0.0 ? noise_(random_) : 0.0; }

  std::normal_distribution<double> noise_;
  std::mt19937 random_{20081};
};

/// Draws the occupancy grid of the scans that are taken from these poses.
inline OccupancyGrid drawn_grid(const FloorPlan& plan, const std::vector<geometry::SE2>& poses) {
  OccupancyGrid grid(0.05);
  Scanner scanner;
  OrientedPointExtractor extractor;
  for (const geometry::SE2& pose : poses) {
    const scan::Scan scan = scanner.scan(plan, pose);
    for (const OrientedPoint& point : extractor.extract(scan, {})) {
      grid.add_ray(pose.translation(), pose * point.p);
    }
  }
  return grid;
}

/// Poses from which all of room() is seen.
inline std::vector<geometry::SE2> poses_in_room() {
  std::vector<geometry::SE2> poses;
  for (const Eigen::Vector2d& place :
       {Eigen::Vector2d(-1.5, 0.5), Eigen::Vector2d(1.0, -1.0), Eigen::Vector2d(3.5, 2.5)}) {
    for (double yaw = 0.0; yaw < 6.2; yaw += 0.3) {
      poses.push_back({place.x(), place.y(), yaw});
    }
  }
  return poses;
}

}  // namespace nodmap::slam2d::test
