// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/params.hpp"
#include "modules/slam6d/pose_update.hpp"
#include "modules/slam6d/registration/registration.hpp"
#include "modules/slam6d/sweep/mount_error.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"
#include "modules/slam6d/tracking/odometry_calibration.hpp"
#include "modules/slam6d/tracking/odometry_prior.hpp"
#include "modules/slam6d/tracking/odometry_scatter.hpp"
#include "modules/slam6d/tracking/pitch_latency.hpp"

namespace nodmap::slam6d {

/// Follows the robot from sweep to sweep: odometry predicts the pose of a sweep in the map,
/// registration measures it. Meanwhile it learns the constant errors of the wheels and of the
/// pitch's stamps.
class Tracker {
 public:
  /// `mount`: the error of the laser's mount, which is corrected.
  explicit Tracker(const Slam6dParams& params, const MountError& mount = {});

  /// Continues with odometry in another frame; the motion in between is unknown.
  void change_odometry_frame(const geometry::SE3& T_old_new);
  /// The motion before the next sweep is unknown.
  void interrupt() { is_interrupted_ = true; }

  /// Later sweeps are deskewed with another error of the laser's mount.
  void correct_mount(const MountError& mount) { mount_ = mount; }

  /// Deskews a sweep with the calibration learned so far.
  [[nodiscard]] SweepCloud deskew(const PlacedSweep& sweep) const;

  /// The pose of the robot by odometry since the last accepted pose.
  [[nodiscard]] PoseUpdate extrapolate(const SweepCloud& cloud) const;
  /// The same for the pose alone. `T_first_base`: as odometry counted it, in the first odom frame.
  [[nodiscard]] geometry::SE3 extrapolate(const geometry::SE3& T_first_base) const {
    return T_map_end_ * calibration_.calibrate(T_first_end_.inverse() * T_first_base);
  }

  /// Registers the sweep of an extrapolated pose with the map. If the wheels slipped, the cloud is
  /// deskewed without that part of their motion.
  void track(VoxelMap& sweep, const VoxelMap& map, SweepCloud& cloud, PoseUpdate& update);

  /// Refuses the sweep that was just tracked, because its pose is wrong.
  void refuse();

  /// To be called with each sweep whose pose is not accepted: sums up the motion during it.
  void pass(const SweepCloud& cloud);

  /// Accepts a pose, from which the next one is extrapolated. Deskews the cloud with the motion
  /// that was found.
  void accept(SweepCloud& cloud, PoseUpdate& update);

  /// The correction of odometry since the last accepted pose.
  [[nodiscard]] const geometry::SE3& T_map_odom() const { return T_map_odom_; }
  /// Whether a pose was accepted.
  [[nodiscard]] bool has_pose() const { return has_pose_; }
  void forget_pose() { has_pose_ = false; }
  /// Begins at `T_map_base`, a pose from another source, with the uncertainty of an interruption.
  void begin_at(const geometry::SE3& T_map_base, const SweepCloud& cloud);
  /// The map around the robot has moved.
  void move(const geometry::SE3& T_new_old);

  /// Learns the pitch latency from the first two sweeps, if the robot is stationary: from how the
  /// second one (extrapolated pose `update`) fits `map`, which is the first. Returns whether it
  /// did.
  bool learn_pitch_latency_at_start(VoxelMap& sweep, const VoxelMap& map, const SweepCloud& cloud,
                                    const PoseUpdate& update, double first_pitch_rate_rad_s);

  [[nodiscard]] const OdometryCalibration& calibration() const { return calibration_; }
  /// OdometryScatter::factor() of the wheels.
  [[nodiscard]] double odometry_scatter() const { return scatter_.factor(); }
  [[nodiscard]] const MountError& mount() const { return mount_; }
  [[nodiscard]] double pitch_latency_s() const { return pitch_latency_.seconds(); }
  /// Number of sweeps refused since the last accepted one.
  [[nodiscard]] int lost_sweeps() const { return lost_sweeps_; }

 private:
  [[nodiscard]] OdometryMotion motion_since_accepted(const SweepCloud& cloud) const;
  [[nodiscard]] geometry::SE3 counted_since_accepted(const geometry::SE3& T_odom_base) const;
  [[nodiscard]] PosePrior predict(const SweepCloud& cloud, const PoseUpdate& update) const;
  void look_for_slip(VoxelMap& sweep, const VoxelMap& map, SweepCloud& cloud,
                     const PosePrior& prior, Registration& registration) const;
  void calibrate(const SweepCloud& cloud, const PoseUpdate& predicted, const PoseUpdate& update);
  void learn_pitch_latency(const SweepCloud& cloud, const PoseUpdate& update);

  OdometryParams odometry_;
  RegistrationParams registration_;
  RangeLimits range_;
  VoxelMapParams voxels_;
  MountError mount_;
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
  geometry::SE3 last_motion_ = geometry::SE3::Identity();  ///< from its middle to its last beam
  Matrix6d end_covariance_ = Matrix6d::Zero();
  /// The motion by odometry from there to the end of the last sweep, summed from sweep to sweep: a
  /// robot that turned by 350 degrees did not turn by 10. And the pose at that end.
  OdometryMotion passed_;
  geometry::SE3 T_first_passed_ = geometry::SE3::Identity();
  /// The present odom frame in the first one.
  geometry::SE3 T_first_odom_ = geometry::SE3::Identity();
  bool has_pose_ = false;
  int lost_sweeps_ = 0;          // since the last accepted one
  bool is_interrupted_ = false;  // since the last accepted one
};

}  // namespace nodmap::slam6d
