// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "modules/slam6d/pose_update.hpp"

namespace nodmap::slam6d {

/// The pose with its rotation orthonormalised, because rounding errors grow with each change of a
/// pose.
[[nodiscard]] inline geometry::SE3 normalized(const geometry::SE3& pose) {
  return geometry::make_se3(pose.translation(), Eigen::Quaterniond(pose.linear()).normalized());
}

/// How much of the robot's path is kept.
struct PathParams {
  int max_sweeps = 131'072;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("max_sweeps", max_sweeps, {10, 100'000'000},
              "Maximum number of sweeps whose poses are kept, 0.4 kB each. Beyond it, apart from "
              "the newest, every second sweep is kept, then every fourth; keyframes always are.");
  }
};

/// Where the robot was at one sweep.
struct SweepPose {
  std::size_t sweep = 0;  ///< counts all sweeps from 0
  time::Timestamp stamp{};
  geometry::SE3 T_first_base = geometry::SE3::Identity();  ///< by odometry, in the first odom frame
  geometry::SE3 T_map_base_online = geometry::SE3::Identity();  ///< when the sweep was complete
  geometry::SE3 T_map_base = geometry::SE3::Identity();         ///< as known now
  bool is_tracked = false;                                      ///< PoseUpdate::is_tracked()
  bool is_place_known = true;
  int odometry_frame = 0;  ///< how often odometry had restarted
};

/// Where the robot was at each sweep. All that is kept of a sweep that is no keyframe: during a
/// drive of days only every second sweep is kept, then every fourth, and so on.
class CorrectedPoses {
 public:
  explicit CorrectedPoses(const PathParams& params = {})
      : max_sweeps_(static_cast<std::size_t>(params.max_sweeps)) {}

  /// Adds the next sweep.
  void add(const PoseUpdate& update);
  /// The newest sweep's pose in the end, when loops have been closed with it.
  void set_online(const geometry::SE3& T_map_base) {
    sweeps_.back().T_map_base_online = T_map_base;
  }

  /// The same for sweeps that were added again, after `published`.
  void keep_online(const CorrectedPoses& published);

  [[nodiscard]] std::span<const SweepPose> sweeps() const { return sweeps_; }
  /// The number of sweeps that were added, which is that of the next one.
  [[nodiscard]] std::size_t num_added() const { return num_added_; }
  [[nodiscard]] bool contains(std::size_t sweep) const;
  /// The pose of a sweep that is kept, as known now.
  [[nodiscard]] const geometry::SE3& pose_of(std::size_t sweep) const;

  /// The new pose of a sweep.
  struct Correction {
    std::size_t sweep = 0;
    geometry::SE3 T_map_base = geometry::SE3::Identity();
  };
  /// Moves these sweeps, in order of time, to their new poses. The corrections of sweeps between
  /// two of them are interpolated.
  void move(std::span<const Correction> corrections);
  /// Sweep `first` and those after it were not tracked after all. Returns how many of them were.
  std::size_t take_back(std::size_t first);
  /// Places sweep `first` and those after it by odometry. `T_map_base_at`: the pose in map of a
  /// pose in the first odom frame.
  void place(std::size_t first,
             const std::function<geometry::SE3(const geometry::SE3& T_first_base)>& T_map_base_at);

  [[nodiscard]] bool is_full() const { return sweeps_.size() >= max_sweeps_; }
  /// Drops sweeps, evenly over the whole path, so that it is full no longer. `used`: sweeps that
  /// are kept, in order.
  void drop_sweeps(std::span<const std::size_t> used);

  /// The pose of each of sweeps(): tracked sweeps as add() and move() set them, those between two
  /// of them by odometry with an interpolated correction. A jump at a restart of odometry moves
  /// only the sweeps after it.
  [[nodiscard]] std::vector<geometry::SE3> trajectory() const;

 private:
  /// The first that is kept from sweep `sweep` on.
  [[nodiscard]] std::vector<SweepPose>::const_iterator find(std::size_t sweep) const;
  [[nodiscard]] std::span<SweepPose> from(std::size_t sweep);

  std::size_t max_sweeps_;
  std::vector<SweepPose> sweeps_;
  std::size_t num_added_ = 0;
  geometry::SE3 T_first_odom_ = geometry::SE3::Identity();  // of the newest sweep
  int odometry_frame_ = 0;
  std::size_t keep_every_ = 1;  // older sweeps
};

}  // namespace nodmap::slam6d
