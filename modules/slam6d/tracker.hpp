// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/odometry_calibration.hpp"
#include "modules/slam6d/odometry_prior.hpp"
#include "modules/slam6d/odometry_scatter.hpp"
#include "modules/slam6d/params.hpp"
#include "modules/slam6d/pitch_latency.hpp"
#include "modules/slam6d/pose_update.hpp"
#include "modules/slam6d/registration.hpp"
#include "modules/slam6d/sweep_cloud.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// Follows the robot from sweep to sweep: odometry tells where a sweep is to be expected in the
/// map, registration where it is. What wheels and the stamps of the pitch are constantly off by is
/// learned along.
class Tracker {
 public:
  explicit Tracker(const Slam6dParams& params);

  /// Odometry goes on in another frame, and nobody saw what happened meanwhile.
  void change_odometry_frame(const geometry::SE3& T_old_new);
  /// Nobody saw what happened before the next sweep.
  void interrupt() { is_interrupted_ = true; }

  /// Deskews with all that was learned so far.
  [[nodiscard]] SweepCloud deskew(const PlacedSweep& sweep) const;

  /// Where the robot is by odometry, from the last accepted pose on.
  [[nodiscard]] PoseUpdate extrapolate(const SweepCloud& cloud) const;

  /// Registers the sweep of an extrapolated pose with the map.
  void track(VoxelMap& sweep, const VoxelMap& map, const SweepCloud& cloud, PoseUpdate& update);

  /// Takes it back that the sweep was tracked: the pose is wrong.
  void refuse();

  /// Takes the pose as the one from which odometry goes on. The cloud is deskewed with the motion
  /// as it was found.
  void accept(SweepCloud& cloud, PoseUpdate& update);

  /// The correction of odometry since the last accepted pose.
  [[nodiscard]] const geometry::SE3& T_map_odom() const { return T_map_odom_; }
  /// Whether a pose was accepted.
  [[nodiscard]] bool has_pose() const { return has_pose_; }
  void forget_pose() { has_pose_ = false; }
  /// The robot is at `T_map_base`, as somebody else says and as far as an interruption leaves open.
  void begin_at(const geometry::SE3& T_map_base, const SweepCloud& cloud);
  /// The map was moved where the robot is.
  void move(const geometry::SE3& T_new_old);

  /// A robot that is stationary during its first two sweeps tells the latency of the pitch by how
  /// the second, whose extrapolated pose is `update`, lies on `map`, which is the first. Returns
  /// whether it does.
  bool learn_pitch_latency_at_start(VoxelMap& sweep, const VoxelMap& map, const SweepCloud& cloud,
                                    const PoseUpdate& update, double first_pitch_rate_rad_s);

  [[nodiscard]] const OdometryCalibration& calibration() const { return calibration_; }
  /// How far the wheels scatter in distance, in parts of what OdometryParams says.
  [[nodiscard]] double odometry_scatter() const { return scatter_.factor(); }
  [[nodiscard]] double pitch_latency_s() const { return pitch_latency_.seconds(); }
  /// Refused since the last accepted one.
  [[nodiscard]] int lost_sweeps() const { return lost_sweeps_; }

 private:
  [[nodiscard]] OdometryMotion motion_since_accepted(const SweepCloud& cloud) const;
  [[nodiscard]] geometry::SE3 counted_since_accepted(const geometry::SE3& T_odom_base) const;
  [[nodiscard]] PosePrior predict(const SweepCloud& cloud, const PoseUpdate& update) const;
  void calibrate(const SweepCloud& cloud, const PoseUpdate& predicted, const PoseUpdate& update);
  void learn_pitch_latency(const SweepCloud& cloud, const PoseUpdate& update);

  OdometryParams odometry_;
  RegistrationParams registration_;
  RangeLimits range_;
  OdometryCalibration calibration_;
  OdometryScatter scatter_;
  PitchLatency pitch_latency_;
  /// What pitch_latency_ compares the next sweep with: the last accepted one.
  struct NoddingSweep {
    geometry::SE3 T_map_base = geometry::SE3::Identity();
    geometry::SE3 T_first_base =
        geometry::SE3::Identity();  ///< as counted, in the first odom frame
    double pitch_rate_rad_s = 0.0;  ///< as far as the estimate follows it
    double pitch_variance = 0.0;
    double latency_s = 0.0;  ///< with which it was deskewed
    bool is_stationary = false;
  };
  std::optional<NoddingSweep> last_nod_;

  /// P_n * odo_n^-1 at the last beam of the last accepted sweep: the correction, map from odom.
  geometry::SE3 T_map_odom_ = geometry::SE3::Identity();
  /// That pose, in map and by odometry in the first odom frame, and its covariance.
  geometry::SE3 T_map_end_ = geometry::SE3::Identity();
  geometry::SE3 T_first_end_ = geometry::SE3::Identity();
  Matrix6d end_covariance_ = Matrix6d::Zero();
  /// The present odom frame in the first one.
  geometry::SE3 T_first_odom_ = geometry::SE3::Identity();
  bool has_pose_ = false;
  int lost_sweeps_ = 0;          // since the last accepted one
  bool is_interrupted_ = false;  // since the last accepted one
};

}  // namespace nodmap::slam6d
