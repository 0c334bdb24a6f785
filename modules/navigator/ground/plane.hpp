// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

namespace nodmap::navigator {

/// z = height_m + slope . (p - origin), metres; frame odom, z from the floor at the start.
struct Plane {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double height_m = 0.0;

  [[nodiscard]] double at(const Eigen::Vector2d& p) const {
    return height_m + slope.dot(p - origin);
  }
};

/// Fits a plane to points by least squares of the vertical residuals. Keeps only sums.
class PlaneFit {
 public:
  void add(const Eigen::Vector3d& p) {
    if (num_points_ == 0) {
      origin_ = p.head<2>();
    }
    ++num_points_;
    const Eigen::Vector3d row(p.x() - origin_.x(), p.y() - origin_.y(), 1.0);
    A_ += row * row.transpose();
    b_ += p.z() * row;
  }

  /// The plane; empty if all points lie on a line.
  [[nodiscard]] std::optional<Plane> solve() const;

  /// The level plane at the points' mean height.
  [[nodiscard]] Plane level() const {
    return {origin_, Eigen::Vector2d::Zero(), b_.z() / std::max(1, num_points_)};
  }

 private:
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  Eigen::Matrix3d A_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b_ = Eigen::Vector3d::Zero();
  int num_points_ = 0;
};

}  // namespace nodmap::navigator
