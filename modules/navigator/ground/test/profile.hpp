// SPDX-License-Identifier: BSD-3-Clause
// For tests: ground that rises and falls along x only, and the scans of a robot that stands on it.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "common/scan/scan.hpp"
#include "modules/navigator/test/kurt_scan.hpp"

namespace nodmap::navigator::test {

/// Straight lines between knots (x, z); two knots at the same x are a step.
struct Profile {
  std::vector<Eigen::Vector2d> knots;

  [[nodiscard]] double height_m(double x) const {
    for (std::size_t i = 1; i < knots.size(); ++i) {
      const Eigen::Vector2d& a = knots[i - 1];
      const Eigen::Vector2d& b = knots[i];
      if (x >= a.x() && x < b.x()) {
        return a.y() + (b.y() - a.y()) * (x - a.x()) / (b.x() - a.x());
      }
    }
    return knots.back().y();
  }

  /// Distance to the first intersection of a ray with the lines, in closed form; +infinity without
  /// one.
  [[nodiscard]] double range_m(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < knots.size(); ++i) {
      const Eigen::Vector2d along = knots[i] - knots[i - 1];
      // origin + t ray = a + s along, in x and z.
      const double det = ray.z() * along.x() - ray.x() * along.y();
      const Eigen::Vector2d d = knots[i - 1] - Eigen::Vector2d(origin.x(), origin.z());
      const double t = (d.y() * along.x() - d.x() * along.y()) / det;
      const double s = (ray.x() * d.y() - ray.z() * d.x()) / det;
      if (t > 0.05 && s >= 0.0 && s <= 1.0) {
        nearest = std::min(nearest, t);
      }
    }
    return nearest;
  }

  /// Pose of base heading along x, on wheels 0.15 m before and behind it.
  [[nodiscard]] geometry::SE3 pose_at(double x) const {
    const double front = height_m(x + 0.15);
    const double rear = height_m(x - 0.15);
    geometry::SE3 pose = geometry::SE3::Identity();
    pose.linear() = geometry::pitch_rotation(std::atan2(front - rear, 0.3));
    pose.translation() = Eigen::Vector3d(x, 0.0, 0.5 * (front + rear));
    return pose;
  }
};

/// The laser of KURT3D at 75 scans a second, nodding over the full range while the robot drives.
class NoddingRobot {
 public:
  NoddingRobot(Profile profile, double range_sigma_m, double x = 0.0)
      : profile_(std::move(profile)), noise_(0.0, range_sigma_m), x_(x) {}

  [[nodiscard]] double x() const { return x_; }
  [[nodiscard]] geometry::SE2 T_odom_base() const { return {x_, 0.0, 0.0}; }
  [[nodiscard]] geometry::SE3 true_pose() const { return profile_.pose_at(x_); }

  /// The next scan, after driving for one scan's time.
  scan::Scan step(double forward_mps) {
    constexpr double kLineRad = geometry::deg_to_rad(1.65);
    constexpr int kLines = 73;  // from 60 degrees down to 60 up
    x_ += 0.01332 * forward_mps;
    const int line =
        num_scans_ / kLines % 2 == 0 ? num_scans_ % kLines : kLines - 1 - num_scans_ % kLines;
    ++num_scans_;
    return scan_at(geometry::deg_to_rad(-60.0) + kLineRad * line);
  }

 private:
  scan::Scan scan_at(double pitch_rad) {
    scan::Scan scan = kurt_scan(true_pose(), pitch_rad,
                                [this](const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
                                  return profile_.range_m(origin, ray) + noise_(random_);
                                });
    scan.duration = 6660us;
    return scan;
  }

  Profile profile_;
  std::mt19937 random_{1};
  std::normal_distribution<double> noise_;
  double x_;
  int num_scans_ = 0;
};

}  // namespace nodmap::navigator::test
