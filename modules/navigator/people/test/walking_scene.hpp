// SPDX-License-Identifier: BSD-3-Clause
// For tests: a floor with a wall and people, and the scans that an ideal nodding laser takes of
// them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "common/scan/scan.hpp"
#include "modules/navigator/test/kurt_scan.hpp"

namespace nodmap::navigator::test {

/// Time from one scan to the next: a mirror revolution.
constexpr double kScanS = 0.01332;

inline time::Timestamp at(double time_s) {
  return time::Timestamp(time::from_seconds(time_s));
}

/// An upright cylinder on the floor.
struct Pillar {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double radius_m = 0.25;
  double height_m = 1.7;
};

struct WalkingScene {
  std::vector<Pillar> pillars;
  double wall_x_m = 6.0;  ///< a wall across the way, endlessly high

  /// Range to the first surface, by the closed forms of plane and cylinder; +infinity without one.
  [[nodiscard]] double range_m(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) const {
    double range = std::numeric_limits<double>::infinity();
    if (ray.z() < 0.0) {
      range = -origin.z() / ray.z();
    }
    if (ray.x() > 0.0) {
      range = std::min(range, (wall_x_m - origin.x()) / ray.x());
    }
    for (const Pillar& pillar : pillars) {
      const Eigen::Vector2d from = origin.head<2>() - pillar.center;
      const double a = ray.head<2>().squaredNorm();
      const double b = from.dot(ray.head<2>());
      const double c = from.squaredNorm() - pillar.radius_m * pillar.radius_m;
      const double root = b * b - a * c;
      const double r = root < 0.0 ? -1.0 : (-b - std::sqrt(root)) / a;
      if (r > 0.0 && origin.z() + r * ray.z() <= pillar.height_m) {
        range = std::min(range, r);
      }
    }
    return range;
  }

  [[nodiscard]] scan::Scan scan(time::Timestamp stamp, const geometry::SE2& T_odom_base,
                                double pitch_rad) const {
    scan::Scan scan = kurt_scan(geometry::to_se3(T_odom_base), pitch_rad,
                                [this](const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
                                  return range_m(origin, ray);
                                });
    scan.stamp = stamp;
    return scan;
  }
};

/// A scan of a level laser: beams 0.375 degrees apart, 270 degrees wide.
inline scan::Scan level_scan(const WalkingScene& scene, time::Timestamp stamp,
                             const geometry::SE2& T_odom_base) {
  scan::Scan scan = scene.scan(stamp, T_odom_base, 0.0);
  scan.angle_first_rad = -0.75 * geometry::kPi;
  scan.angle_step_rad = geometry::deg_to_rad(0.375);
  scan.ranges_m.resize(721);
  const geometry::SE3 T_odom_mount = geometry::to_se3(T_odom_base) * scan.T_base_mount;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    scan.ranges_m[i] = static_cast<float>(
        scene.range_m(T_odom_mount.translation(),
                      T_odom_mount.linear() * scan::beam_direction(scan.angle_rad(i), 0.0)));
  }
  return scan;
}

/// Pitch, at a time, of a head that nods between -40 and 10 degrees at 3 rad/s.
inline double nodding_pitch_rad(double time_s) {
  const double range_rad = geometry::deg_to_rad(50.0);
  const double phase = std::fmod(3.0 * time_s, 2.0 * range_rad);
  return geometry::deg_to_rad(10.0) - (phase < range_rad ? phase : 2.0 * range_rad - phase);
}

}  // namespace nodmap::navigator::test
