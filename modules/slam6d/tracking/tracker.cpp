// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/tracker.hpp"

#include "common/registration/pose_edges.hpp"
#include "modules/slam6d/registration/heading_search.hpp"
#include "modules/slam6d/registration/slide_search.hpp"
#include "modules/slam6d/registration/slip_search.hpp"
#include "modules/slam6d/tracking/corrected_poses.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

OdometryMotion motion_of(const SE3& motion) {
  return {.distance_m = motion.translation().norm(),
          .rotation_rad = geometry::rotation_angle(motion)};
}

// The direction of the robot's pitch, positive upwards, in the six directions of a covariance.
Vector6d pitch_axis(const SE3& T_map_base) {
  Vector6d axis = Vector6d::Zero();
  axis.tail<3>() = -T_map_base.linear().col(1);
  return axis;
}

}  // namespace

Tracker::Tracker(const Slam6dParams& params, const MountError& mount)
    : odometry_(params.odometry),
      registration_(params.registration),
      range_(params.range),
      voxels_(params.voxels),
      mount_(mount),
      calibration_(params.calibration),
      scatter_(params.calibration.min_scatter),
      pitch_latency_(params.pitch_latency) {}

void Tracker::change_odometry_frame(const SE3& T_old_new) {
  T_map_odom_ = T_map_odom_ * T_old_new;
  T_first_odom_ = T_first_odom_ * T_old_new;
  is_interrupted_ = true;
}

SweepCloud Tracker::deskew(const PlacedSweep& sweep) const {
  return slam6d::deskew(
      sweep, range_, [this](const SE3& motion) { return calibration_.calibrate(motion); },
      pitch_latency_.seconds(), mount_);
}

// Reference [5]: odometry's motion since the last registered pose, in that pose's frame:
// P_n+1 = P_n (odo_n^-1 odo_n+1).
PoseUpdate Tracker::extrapolate(const SweepCloud& cloud) const {
  PoseUpdate update{.stamp = cloud.stamp,
                    .T_odom_base = cloud.T_odom_base,
                    .T_first_odom = T_first_odom_,
                    .scans_used = cloud.scans_used,
                    .num_points = cloud.points.size(),
                    .is_stationary = cloud.is_stationary()};
  update.T_map_base =
      has_pose_ ? T_map_end_ * calibration_.calibrate(counted_since_accepted(cloud.T_odom_base))
                : T_map_odom_ * cloud.T_odom_base;
  update.T_map_odom = update.T_map_base * cloud.T_odom_base.inverse();
  if (has_pose_) {
    update.covariance = predict(cloud, update).covariance;
  }
  return update;
}

// The motion from the end of the last accepted sweep, as odometry counted it.
SE3 Tracker::counted_since_accepted(const SE3& T_odom_base) const {
  return T_first_end_.inverse() * T_first_odom_ * T_odom_base;
}

OdometryMotion Tracker::motion_since_accepted(const SweepCloud& cloud) const {
  OdometryMotion motion = motion_of(T_first_passed_.inverse() * T_first_odom_ * cloud.T_odom_base *
                                    cloud.T_base_first_counted);
  motion.distance_m += passed_.distance_m;
  motion.rotation_rad += passed_.rotation_rad;
  motion.is_interrupted = is_interrupted_;
  motion.lost_sweeps = lost_sweeps_;
  motion.scatter = scatter_.factor();
  return motion;
}

PosePrior Tracker::predict(const SweepCloud& cloud, const PoseUpdate& update) const {
  const SE3& T_map_base = update.T_map_base;
  std::optional<PosePrior::Level> level;
  if (is_planar(cloud.T_odom_base)) {
    level = {.height_m = 0.0, .ground = level_ground_at(T_map_base, odometry_)};
  }
  OdometryMotion within = motion_of(cloud.motion());
  within.lost_sweeps = lost_sweeps_;  // wheels that spin do so during the sweep as well
  within.scatter = scatter_.factor();
  return {.T_map_base = T_map_base,
          .covariance = end_covariance_ +
                        odometry_covariance(T_map_base, motion_since_accepted(cloud), odometry_),
          .motion_covariance = odometry_covariance(T_map_base, within, odometry_),
          .level = level};
}

// IV B: "registered into an incrementally built 3D model"; IV: "the same transformation can be
// applied [...] to correct the former pose estimation obtained via odometry".
void Tracker::track(VoxelMap& sweep, const VoxelMap& map, SweepCloud& cloud, PoseUpdate& update) {
  const PoseUpdate predicted = update;
  const PosePrior prior = predict(cloud, update);
  update.registration = is_interrupted_ ? register_sweep_sliding(sweep, map, prior, registration_)
                                        : register_sweep(sweep, map, prior, registration_);
  if (!is_interrupted_) {
    look_for_slip(sweep, map, cloud, prior, *update.registration);
    // It may still be wrong by more than its covariance says.
    if (update.registration->is_accepted() && is_far_from_odometry(*update.registration)) {
      update.registration->state = PoseState::kDegraded;
    }
  }
  update.T_map_base = update.registration->T_map_base;
  update.covariance = update.registration->covariance;
  calibrate(cloud, predicted, update);
  learn_pitch_latency(cloud, update);
  if (!update.registration->is_accepted()) {
    ++lost_sweeps_;
    scatter_.forget();
  }
}

// Wheels that push against an obstacle count a motion that the robot does not make.
void Tracker::look_for_slip(VoxelMap& sweep, const VoxelMap& map, SweepCloud& cloud,
                            const PosePrior& prior, Registration& registration) const {
  const Eigen::Vector3d p_map_last = T_map_end_.translation();
  CountedMotion counted{
      .T_map_last = T_map_end_,
      .last_motion = last_motion_,
      .to_first_m = prior.T_map_base * cloud.T_base_first.translation() - p_map_last,
      .to_last_m = prior.T_map_base * cloud.T_base_last.translation() - p_map_last};
  const auto ratio = doubtful_ratio(sweep, map, registration, counted, registration_);
  if (!ratio) {
    return;
  }
  counted.inlier_ratio = *ratio;
  if (auto slipped = register_slipped(cloud, sweep, map, prior, registration, counted,
                                      registration_, voxels_)) {
    cloud = std::move(slipped->cloud);
    sweep = std::move(slipped->voxels);
    registration = slipped->registration;
  }
}

// Learns the errors of the wheels from the motion since the last sweep.
void Tracker::calibrate(const SweepCloud& cloud, const PoseUpdate& predicted,
                        const PoseUpdate& update) {
  const Registration& registration = *update.registration;
  if (registration.is_slipped) {
    scatter_.forget();
  }
  if (!registration.is_accepted() || registration.is_slipped || is_interrupted_ ||
      lost_sweeps_ > 0) {
    return;
  }
  const SE3 T_map_predicted = predicted.T_map_base * cloud.T_base_last;
  const SE3 T_map_end = update.T_map_base * registration.correction.correct(cloud.T_base_last, 1.0);
  const SE3 deviation = T_map_predicted.inverse() * T_map_end;
  const Matrix6d random_covariance =
      0.1 * odometry_covariance(T_map_end, motion_of(cloud.motion()), odometry_);
  const auto evidence = [&](double deviation_along, const Vector6d& axis) -> MotionEvidence {
    const auto variance = [&axis](const Matrix6d& covariance) {
      return axis.dot(covariance * axis);
    };
    return {.deviation = deviation_along,
            .prior_variance = variance(registration.prior_end_covariance),
            .posterior_variance = variance(registration.end_covariance),
            .start_variance = variance(end_covariance_),
            .random_variance = variance(random_covariance)};
  };
  Vector6d forward = Vector6d::Zero();
  forward.head<3>() = T_map_end.linear().col(0);
  Vector6d yaw = Vector6d::Zero();
  yaw.tail<3>() = T_map_end.linear().col(2);
  const SE3 counted = counted_since_accepted(cloud.T_odom_base * cloud.T_base_last_counted);
  const MotionEvidence distance = evidence(deviation.translation().x(), forward);
  const Matrix6d covariance = odometry_covariance(T_map_end, motion_of(counted), odometry_);
  scatter_.learn(distance, forward.dot(covariance * forward));
  calibration_.learn(counted, distance,
                     evidence(geometry::rotation_vector(deviation.linear()).z(), yaw));
}

// Learns the pitch latency from the change of the robot's pitch since the last sweep that level
// ground does not explain.
void Tracker::learn_pitch_latency(const SweepCloud& cloud, const PoseUpdate& update) {
  const Registration& registration = *update.registration;
  if (!registration.is_accepted() || registration.is_slipped || !is_planar(cloud.T_odom_base)) {
    last_nod_.reset();
    return;
  }
  const Vector6d axis = pitch_axis(update.T_map_base);
  const NoddingSweep nod{
      .T_map_base = update.T_map_base,
      .T_first_base = T_first_odom_ * cloud.T_odom_base,
      .pitch_rate_rad_s = axis.dot(registration.response * axis) * cloud.pitch_rate_rad_s,
      .pitch_variance = axis.dot(registration.covariance * axis),
      .latency_s = pitch_latency_.seconds(),
      .is_stationary = update.is_stationary};
  if (last_nod_ && !is_interrupted_ && lost_sweeps_ == 0) {
    const SE3 motion = calibration_.calibrate(last_nod_->T_first_base.inverse() * nod.T_first_base);
    const SE3 deviation = (last_nod_->T_map_base * motion).inverse() * nod.T_map_base;
    // The last sweep, had it been deskewed as this one.
    const double learned_s = nod.latency_s - last_nod_->latency_s;
    const double pitch_rad = -geometry::rotation_vector(deviation.linear()).y() +
                             learned_s * last_nod_->pitch_rate_rad_s;
    const bool is_same_ground = nod.is_stationary && last_nod_->is_stationary;
    const double level_sigma_rad = odometry_.level_tilt_rad;
    pitch_latency_.learn(nod.pitch_rate_rad_s - last_nod_->pitch_rate_rad_s, pitch_rad,
                         nod.pitch_variance + last_nod_->pitch_variance +
                             (is_same_ground ? 0.0 : 2.0 * level_sigma_rad * level_sigma_rad));
  }
  last_nod_ = nod;
}

bool Tracker::learn_pitch_latency_at_start(VoxelMap& sweep, const VoxelMap& map,
                                           const SweepCloud& cloud, const PoseUpdate& update,
                                           double first_pitch_rate_rad_s) {
  const Registration found = register_sweep(sweep, map, predict(cloud, update), registration_);
  if (!found.is_accepted()) {
    return false;
  }
  const Vector6d axis = pitch_axis(found.T_map_base);
  const SE3 deviation = update.T_map_base.inverse() * found.T_map_base;
  pitch_latency_.learn(
      axis.dot(found.response * axis) * (cloud.pitch_rate_rad_s - first_pitch_rate_rad_s),
      -geometry::rotation_vector(deviation.linear()).y(), axis.dot(found.covariance * axis));
  return true;
}

void Tracker::refuse() {
  ++lost_sweeps_;
  scatter_.forget();
  last_nod_.reset();
}

void Tracker::pass(const SweepCloud& cloud) {
  const SE3 T_first_base = T_first_odom_ * cloud.T_odom_base;
  for (const SE3& T_base_counted :
       {cloud.T_base_first_counted, SE3(SE3::Identity()), cloud.T_base_last_counted}) {
    const SE3 T_first_counted = T_first_base * T_base_counted;
    const OdometryMotion motion = motion_of(T_first_passed_.inverse() * T_first_counted);
    passed_.distance_m += motion.distance_m;
    passed_.rotation_rad += motion.rotation_rad;
    T_first_passed_ = T_first_counted;
  }
}

void Tracker::accept(SweepCloud& cloud, PoseUpdate& update) {
  const SE3 T_odom_end = update.T_odom_base * cloud.T_base_last_counted;
  if (update.registration) {
    cloud.correct(update.registration->correction);
    end_covariance_ = update.registration->end_covariance;
  }
  last_motion_ = cloud.T_base_last;
  T_map_end_ = update.T_map_base * last_motion_;
  T_map_odom_ = T_map_end_ * T_odom_end.inverse();
  T_first_end_ = T_first_passed_ = T_first_odom_ * T_odom_end;
  passed_ = {};
  update.T_map_odom = T_map_odom_;
  has_pose_ = true;
  lost_sweeps_ = 0;
  is_interrupted_ = false;
}

void Tracker::begin_at(const SE3& T_map_base, const SweepCloud& cloud) {
  last_motion_.setIdentity();
  T_map_end_ = T_map_base;
  T_map_odom_ = T_map_base * cloud.T_odom_base.inverse();
  T_first_end_ = T_first_passed_ = T_first_odom_ * cloud.T_odom_base;
  passed_ = {};
  end_covariance_.setZero();
  last_nod_.reset();
  has_pose_ = true;
  lost_sweeps_ = 0;
  is_interrupted_ = true;
}

void Tracker::move(const SE3& T_new_old) {
  T_map_odom_ = normalized(T_new_old * T_map_odom_);
  T_map_end_ = normalized(T_new_old * T_map_end_);
  end_covariance_ = registration::rotated(end_covariance_, T_new_old.linear());
  if (last_nod_) {
    last_nod_->T_map_base = normalized(T_new_old * last_nod_->T_map_base);
  }
}

}  // namespace nodmap::slam6d
