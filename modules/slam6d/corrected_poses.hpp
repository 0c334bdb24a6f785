// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/pose_update.hpp"

namespace nodmap::slam6d {

/// The pose with its rotation orthonormalised, because rounding errors grow with each change of a
/// pose.
[[nodiscard]] inline geometry::SE3 normalized(const geometry::SE3& pose) {
  return geometry::make_se3(pose.translation(), Eigen::Quaterniond(pose.linear()).normalized());
}

/// The poses of all sweeps as they are known now. (A PoseUpdate keeps the pose known when its sweep
/// was complete.)
class CorrectedPoses {
 public:
  void add(const geometry::SE3& T_map_base) { poses_.push_back(T_map_base); }
  void replace(std::size_t sweep, const geometry::SE3& T_map_base) { poses_[sweep] = T_map_base; }

  [[nodiscard]] std::span<const geometry::SE3> poses() const { return poses_; }

  /// The new pose of a sweep.
  struct Correction {
    std::size_t sweep = 0;
    geometry::SE3 T_map_base = geometry::SE3::Identity();
  };
  /// Moves these sweeps, in order of time, to their new poses. The corrections of sweeps between
  /// two of them are interpolated.
  void move(std::span<const Correction> corrections);

  /// The poses of all sweeps: tracked sweeps as add() and move() set them, those between two of
  /// them by odometry with an interpolated correction. `sweeps`: as many as were added.
  [[nodiscard]] std::vector<geometry::SE3> trajectory(std::span<const PoseUpdate> sweeps) const;

 private:
  std::vector<geometry::SE3> poses_;
};

}  // namespace nodmap::slam6d
