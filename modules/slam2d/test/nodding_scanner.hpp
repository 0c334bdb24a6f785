// SPDX-License-Identifier: BSD-3-Clause
// Worlds of plane surfaces, walls and ramps, and a simulated nodding SICK scanner in them.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "common/scan/scan.hpp"

namespace nodmap::slam2d::test {

/// Plane surfaces: the points with normal.dot(p) == offset_m for which `is_there`.
struct Surface {
  Eigen::Vector3d normal;
  double offset_m = 0.0;
  std::function<bool(const Eigen::Vector3d&)> is_there = [](const Eigen::Vector3d&) {
    return true;
  };
};
using Surfaces = std::vector<Surface>;

/// Ascends ahead from x = `foot_m` at z = 0.
inline Surface ramp(double slope_deg, double foot_m) {
  const double slope = std::tan(geometry::deg_to_rad(slope_deg));
  return {{-slope, 0.0, 1.0}, -slope * foot_m, [=](const Eigen::Vector3d& p) {
            return p.x() > foot_m && std::abs(p.y()) < 2.0;
          }};
}

/// A hall: walls ahead at 12 m, and 2 m to both sides.
inline Surfaces hall() {
  return {{{1, 0, 0}, 12.0}, {{0, 1, 0}, 2.0}, {{0, 1, 0}, -2.0}};
}

/// A laser 0.38 m above the ground, 15 cm ahead of base, with the range noise of a SICK.
class NoddingScanner {
 public:
  explicit NoddingScanner(double noise_m = 0.01) : noise_(0.0, 1.0), noise_m_(noise_m) {}

  scan::Scan scan(const Surfaces& surfaces, double pitch_deg, const geometry::SE3& T_world_base) {
    scan::Scan scan;
    scan.angle_first_rad = -geometry::kPi / 2;
    scan.angle_step_rad = geometry::deg_to_rad(1.0);
    scan.range_min_m = 0.05;
    scan.range_max_m = 30.0;
    scan.pitch_first_rad = scan.pitch_last_rad = geometry::deg_to_rad(pitch_deg);
    scan.T_base_mount.translation() = Eigen::Vector3d(0.15, 0.0, 0.38);
    for (std::size_t beam = 0; beam < 181; ++beam) {
      const Eigen::Vector3d origin = T_world_base * scan.T_base_mount.translation();
      const Eigen::Vector3d ray =
          T_world_base.linear() *
          scan::beam_direction(geometry::deg_to_rad(static_cast<double>(beam) - 90.0),
                               scan.pitch_first_rad);
      double range_m = std::numeric_limits<double>::infinity();
      for (const Surface& surface : surfaces) {
        const double r = (surface.offset_m - surface.normal.dot(origin)) / surface.normal.dot(ray);
        if (r > 0.0 && r < range_m && surface.is_there(origin + r * ray)) {
          range_m = r;
        }
      }
      scan.ranges_m.push_back(static_cast<float>(range_m + noise_m_ * noise_(random_)));
    }
    return scan;
  }

 private:
  std::normal_distribution<double> noise_;
  double noise_m_;
  std::mt19937 random_{7};
};

}  // namespace nodmap::slam2d::test
