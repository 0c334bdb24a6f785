// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/slam6d.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "modules/slam6d/odometry_prior.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;
using Vector6d = Eigen::Matrix<double, 6, 1>;

// Odometry is kept as long as a sweep may last, at 10 scans a second (the slowest device known).
std::int64_t history_span_us(const SweepParams& params) {
  return std::int64_t{100'000} * (params.max_scans + 1);
}

constexpr std::int64_t kMaxExtrapolationUs = 50'000;

// Within a sweep. A tenth of the scanner's noise, near as well as at 10 m; more than wheels that
// are held report.
constexpr double kStationaryM = 1e-3;
constexpr double kStationaryRad = 1e-4;

OdometryMotion motion_of(const SE3& motion) {
  return {.distance_m = motion.translation().norm(),
          .rotation_rad = geometry::rotation_angle(motion)};
}

// Odometry of wheels alone: it knows neither height nor tilt.
bool is_planar(const SE3& T_odom_base) {
  return std::abs(T_odom_base.translation().z()) < 1e-6 && T_odom_base.linear()(2, 2) > 1.0 - 1e-12;
}

// Not a ramp, nor another storey.
bool is_level(const SE3& T_map_base, const OdometryParams& odometry) {
  constexpr double kSigmas = 4.0;
  return std::abs(T_map_base.translation().z()) < kSigmas * odometry.level_height_m &&
         T_map_base.linear().col(2).head<2>().norm() < kSigmas * odometry.level_tilt_rad;
}

bool is_stationary(const SweepCloud& cloud) {
  const SE3 motion = cloud.motion();
  return motion.translation().norm() < kStationaryM &&
         geometry::rotation_angle(motion) < kStationaryRad;
}

PointTimes point_times(const SweepCloud& cloud) {
  PointTimes times;
  if (!is_stationary(cloud)) {
    times.half_path = cloud.half_path().cast<float>();
    times.times.reserve(cloud.points.size());
    for (const SweepCloud::Line& line : cloud.lines) {
      times.times.resize(line.end, static_cast<float>(line.time));
    }
  }
  return times;
}

VoxelMap voxelize(const SweepCloud& cloud, const VoxelMapParams& params) {
  return VoxelMap::from_points(cloud.points, cloud.p_base_mirror(), params, point_times(cloud));
}

std::vector<OrientedPoint> oriented_points(const VoxelGrid& grid) {
  std::vector<OrientedPoint> points;
  points.reserve(grid.voxels().size());
  for (const Voxel& voxel : grid.voxels()) {
    points.push_back({voxel.mean, voxel.normal, voxel.weight});
  }
  return points;
}

// The robot's pitch, positive upwards, among the six directions of a covariance.
Vector6d pitch_axis(const SE3& T_map_base) {
  Vector6d axis = Vector6d::Zero();
  axis.tail<3>() = -T_map_base.linear().col(1);
  return axis;
}

}  // namespace

Slam6d::Slam6d(const Slam6dParams& params)
    : params_(params),
      segmenter_(params.sweep),
      odometry_(history_span_us(params.sweep), kMaxExtrapolationUs),
      calibration_(params.calibration),
      pitch_latency_(params.pitch_latency),
      map_(params.voxels),
      back_end_(params.loop, params.registration, params.odometry, params.voxels) {}

bool Slam6d::add_odometry(std::int64_t utime_us, const SE3& T_odom_base) {
  return odometry_.add(utime_us, T_odom_base);
}

std::optional<PoseUpdate> Slam6d::change_odometry_frame(const SE3& T_new_odom_base) {
  auto update = flush();
  if (const auto T_old_odom_base = odometry_.newest()) {
    const SE3 T_old_new = *T_old_odom_base * T_new_odom_base.inverse();
    T_map_odom_ = T_map_odom_ * T_old_new;
    T_first_odom_ = T_first_odom_ * T_old_new;
    is_interrupted_ = keyframe_is_due_ = true;
  }
  odometry_.clear();
  return update;
}

std::optional<PoseUpdate> Slam6d::add_scan(scan::Scan scan) {
  const auto sweep = collect(std::move(scan));
  return sweep ? std::optional(add_sweep(*sweep)) : std::nullopt;
}

std::optional<PoseUpdate> Slam6d::flush() {
  const auto sweep = collect_rest();
  return sweep ? std::optional(add_sweep(*sweep)) : std::nullopt;
}

// IV B: "segment the continuous data flow to reflect one complete pitch movement per point cloud".
std::optional<PlacedSweep> Slam6d::collect(scan::Scan scan) {
  auto sweep = segmenter_.add(std::move(scan));
  return sweep ? place_sweep(std::move(*sweep)) : std::nullopt;
}

std::optional<PlacedSweep> Slam6d::collect_rest() {
  auto sweep = segmenter_.flush();
  return sweep ? place_sweep(std::move(*sweep)) : std::nullopt;
}

std::optional<PlacedSweep> Slam6d::place_sweep(Sweep sweep) {
  const auto pose_at = [this](std::int64_t utime_us) -> std::optional<SE3> {
    if (odometry_.empty() && params_.assume_stationary) {
      return SE3::Identity();
    }
    return odometry_.at(utime_us);
  };
  const std::size_t num_scans = sweep.scans.size();
  scan_counts_.in_sweeps += num_scans;
  stream_was_interrupted_ = stream_was_interrupted_ || sweep.follows_interruption;
  auto placed = place(std::move(sweep.scans), pose_at);
  scan_counts_.without_pose += placed ? placed->scans_without_pose : num_scans;
  if (placed) {
    placed->follows_interruption = std::exchange(stream_was_interrupted_, false);
  }
  return placed;
}

// IV B: "the robot's movement [...] during the pitching movement is stripped from the point cloud".
PoseUpdate Slam6d::add_sweep(const PlacedSweep& sweep) {
  if (first_sweep_) {
    learn_pitch_latency_at_start(sweep);
    first_sweep_.reset();
  } else if (sweeps_.empty()) {
    first_sweep_ = sweep;
  }
  return add_cloud(deskew_now(sweep));
}

SweepCloud Slam6d::deskew_now(const PlacedSweep& sweep) const {
  return deskew(
      sweep, params_.range, [this](const SE3& motion) { return calibration_.calibrate(motion); },
      pitch_latency_.seconds());
}

PoseUpdate Slam6d::add_cloud(SweepCloud cloud) {
  is_interrupted_ = is_interrupted_ || cloud.follows_interruption;
  keyframe_is_due_ = keyframe_is_due_ || cloud.follows_interruption;
  PoseUpdate update = extrapolate(cloud);
  if (!is_usable(update)) {
    keep(update);
    return update;
  }
  VoxelMap sweep = voxelize(cloud, params_.voxels);
  if (is_better_beginning(sweep)) {
    begin_anew(update);
  }
  if (last_accepted_) {
    track(sweep, cloud, update);
  }
  update.keyframe = keyframe_reason(update);
  if (update.is_tracked()) {
    accept(sweep, cloud, update);
  }
  keep(update);
  if (update.keyframe) {
    keep_keyframe(sweep, std::move(cloud));
    close_loops(sweep);
  }
  return sweeps_.back();
}

void Slam6d::keep(const PoseUpdate& update) {
  sweeps_.push_back(update);
  corrected_.add(update.T_map_base);
}

void Slam6d::keep_keyframe(const VoxelMap& sweep, SweepCloud cloud) {
  keyframes_.push_back({sweeps_.size() - 1, sweeps_.back().T_map_base,
                        std::make_shared<const SweepCloud>(std::move(cloud)),
                        oriented_points(sweep.level(0))});
  keyframe_is_due_ = false;
}

// The scanner was already on its way when the first sweep began, or cut short: on such a sliver no
// whole sweep would ever fit.
bool Slam6d::is_better_beginning(const VoxelMap& sweep) const {
  constexpr std::size_t kCutShort = 2;
  return last_accepted_ && counts_.sweeps_tracked + counts_.sweeps_degraded == 0 &&
         sweep.level(0).voxels().size() >= kCutShort * map_.level(0).voxels().size();
}

void Slam6d::begin_anew(PoseUpdate& update) {
  sweeps_[*last_accepted_].keyframe.reset();
  map_ = VoxelMap(params_.voxels);
  keyframes_.clear();
  back_end_ = BackEnd(params_.loop, params_.registration, params_.odometry, params_.voxels);
  last_accepted_.reset();
  counts_.sweeps_lost = 0;
  update.T_map_base = T_map_odom_ * update.T_odom_base;
  update.T_map_odom = T_map_odom_;
}

// Reference [5]: odometry's motion since the last registered pose, in that pose's frame:
// P_n+1 = P_n (odo_n^-1 odo_n+1).
PoseUpdate Slam6d::extrapolate(const SweepCloud& cloud) const {
  PoseUpdate update{.utime_us = cloud.utime_us,
                    .T_odom_base = cloud.T_odom_base,
                    .T_first_odom = T_first_odom_,
                    .scans_used = cloud.scans_used,
                    .scans_without_pose = cloud.scans_without_pose,
                    .num_points = cloud.points.size(),
                    .is_stationary = is_stationary(cloud)};
  update.T_map_base =
      last_accepted_
          ? T_map_end_ * calibration_.calibrate(counted_since_accepted(cloud.T_odom_base))
          : T_map_odom_ * cloud.T_odom_base;
  update.T_map_odom = update.T_map_base * cloud.T_odom_base.inverse();
  if (last_accepted_) {
    update.covariance = predict(cloud, update).covariance;
  }
  return update;
}

// The motion from the end of the last accepted sweep, as odometry counted it.
SE3 Slam6d::counted_since_accepted(const SE3& T_odom_base) const {
  return T_first_end_.inverse() * T_first_odom_ * T_odom_base;
}

bool Slam6d::is_usable(const PoseUpdate& update) const {
  return update.num_points > 0 &&
         update.scans_used >= static_cast<std::size_t>(params_.sweep.min_scans) &&
         (update.is_stationary || !params_.keyframe.stationary_only);
}

OdometryMotion Slam6d::motion_since_accepted(const SweepCloud& cloud) const {
  OdometryMotion motion =
      motion_of(counted_since_accepted(cloud.T_odom_base * cloud.T_base_first_counted));
  motion.is_interrupted = is_interrupted_;
  motion.lost_sweeps = lost_sweeps_;
  return motion;
}

PosePrior Slam6d::predict(const SweepCloud& cloud, const PoseUpdate& update) const {
  const SE3& T_map_base = update.T_map_base;
  std::optional<PosePrior::Level> level;
  if (is_planar(cloud.T_odom_base)) {
    level = {.height_m = 0.0,
             .height_sigma_m = params_.odometry.level_height_m,
             .tilt_sigma_rad = params_.odometry.level_tilt_rad};
  }
  return {
      .T_map_base = T_map_base,
      .covariance = end_covariance_ +
                    odometry_covariance(T_map_base, motion_since_accepted(cloud), params_.odometry),
      .motion_covariance =
          odometry_covariance(T_map_base, motion_of(cloud.motion()), params_.odometry),
      .level = level};
}

// IV B: "registered into an incrementally built 3D model"; IV: "the same transformation can be
// applied [...] to correct the former pose estimation obtained via odometry".
void Slam6d::track(VoxelMap& sweep, const SweepCloud& cloud, PoseUpdate& update) {
  const PoseUpdate predicted = update;
  update.registration = register_sweep(sweep, map_, predict(cloud, update), params_.registration);
  update.T_map_base = update.registration->T_map_base;
  update.covariance = update.registration->covariance;
  calibrate(cloud, predicted, update);
  learn_pitch_latency(cloud, update);
  switch (update.registration->status) {
    case RegistrationStatus::kTracking:
      ++counts_.sweeps_tracked;
      break;
    case RegistrationStatus::kDegraded:
      ++counts_.sweeps_degraded;
      break;
    case RegistrationStatus::kLost:
      ++counts_.sweeps_lost;
      ++lost_sweeps_;
      break;
  }
}

// What the motion since the last sweep says of the wheels.
void Slam6d::calibrate(const SweepCloud& cloud, const PoseUpdate& predicted,
                       const PoseUpdate& update) {
  const Registration& registration = *update.registration;
  if (!registration.is_accepted() || is_interrupted_ || lost_sweeps_ > 0) {
    return;
  }
  const SE3 T_map_predicted = predicted.T_map_base * cloud.T_base_last;
  const SE3 T_map_end = update.T_map_base * registration.correction.correct(cloud.T_base_last, 1.0);
  const SE3 deviation = T_map_predicted.inverse() * T_map_end;
  const Matrix6d random_covariance =
      0.1 * odometry_covariance(T_map_end, motion_of(cloud.motion()), params_.odometry);
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
  calibration_.learn(counted_since_accepted(cloud.T_odom_base * cloud.T_base_last_counted),
                     evidence(deviation.translation().x(), forward),
                     evidence(geometry::rotation_vector(deviation.linear()).z(), yaw));
}

// What the robot's pitch did from the last sweep to this one that level ground does not explain.
void Slam6d::learn_pitch_latency(const SweepCloud& cloud, const PoseUpdate& update) {
  const Registration& registration = *update.registration;
  if (!registration.is_accepted() || !is_planar(cloud.T_odom_base)) {
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
    const double level_sigma_rad = params_.odometry.level_tilt_rad;
    pitch_latency_.learn(nod.pitch_rate_rad_s - last_nod_->pitch_rate_rad_s, pitch_rad,
                         nod.pitch_variance + last_nod_->pitch_variance +
                             (is_same_ground ? 0.0 : 2.0 * level_sigma_rad * level_sigma_rad));
  }
  last_nod_ = nod;
}

// A robot that is stationary at first tells the latency at once, by its second sweep. Then the map
// begins anew with the first one, which else would tilt all that follows.
void Slam6d::learn_pitch_latency_at_start(const PlacedSweep& sweep) {
  const SweepCloud cloud = deskew_now(sweep);
  const PoseUpdate update = extrapolate(cloud);
  if (!last_accepted_ || keyframes_.size() != 1 || !is_usable(update) || !update.is_stationary ||
      !sweeps_.front().is_stationary || sweep.follows_interruption ||
      !is_planar(cloud.T_odom_base)) {
    return;
  }
  VoxelMap voxels = voxelize(cloud, params_.voxels);
  const Registration found =
      register_sweep(voxels, map_, predict(cloud, update), params_.registration);
  if (!found.is_accepted()) {
    return;
  }
  Keyframe& first = keyframes_.front();
  const Vector6d axis = pitch_axis(found.T_map_base);
  const SE3 deviation = update.T_map_base.inverse() * found.T_map_base;
  pitch_latency_.learn(
      axis.dot(found.response * axis) * (cloud.pitch_rate_rad_s - first.cloud->pitch_rate_rad_s),
      -geometry::rotation_vector(deviation.linear()).y(), axis.dot(found.covariance * axis));
  first.cloud = std::make_shared<const SweepCloud>(deskew_now(*first_sweep_));
  const VoxelMap first_voxels = voxelize(*first.cloud, params_.voxels);
  first.points = oriented_points(first_voxels.level(0));
  map_ = VoxelMap(params_.voxels);
  map_.add_sweep(first_voxels, first.T_map_base);
}

// Only what was registered enters the map: a refused sweep leaves no trace.
void Slam6d::accept(const VoxelMap& sweep, SweepCloud& cloud, PoseUpdate& update) {
  map_.add_sweep(sweep, update.T_map_base, keyframes_.size() - (update.keyframe ? 0 : 1));
  const SE3 T_odom_end = update.T_odom_base * cloud.T_base_last_counted;
  if (update.registration) {
    cloud.correct(update.registration->correction);
    end_covariance_ = update.registration->end_covariance;
  }
  T_map_end_ = update.T_map_base * cloud.T_base_last;
  T_map_odom_ = T_map_end_ * T_odom_end.inverse();
  T_first_end_ = T_first_odom_ * T_odom_end;
  update.T_map_odom = T_map_odom_;
  last_accepted_ = sweeps_.size();
  lost_sweeps_ = 0;
  is_interrupted_ = false;
}

// IV B: "only those whose robot base poses P_b are further than 2 m away from each other or that
// correspond to a rotation of more than 45 deg".
std::optional<KeyframeReason> Slam6d::keyframe_reason(PoseUpdate& update) const {
  if (keyframes_.empty()) {
    return KeyframeReason::kFirst;
  }
  const SE3 motion = keyframes_.back().T_map_base.inverse() * update.T_map_base;
  update.distance_m = motion.translation().norm();
  update.rotation_rad = geometry::rotation_angle(motion);
  if (!update.is_tracked()) {
    return std::nullopt;
  }
  if (keyframe_is_due_) {
    return KeyframeReason::kInterruption;
  }
  if (update.distance_m > params_.keyframe.distance_m) {
    return KeyframeReason::kDistance;
  }
  if (update.rotation_rad > params_.keyframe.rotation_rad) {
    return KeyframeReason::kRotation;
  }
  return std::nullopt;
}

Metrics Slam6d::metrics() const {
  Metrics metrics = counts_;
  metrics.map_voxels = map_.level(0).voxels().size();
  metrics.map_memory_bytes = map_.memory_bytes();
  return metrics;
}

void Slam6d::close_loops(const VoxelMap& sweep) {
  if (!params_.loop.enabled) {
    return;
  }
  const Keyframe& keyframe = keyframes_.back();
  PoseUpdate& update = sweeps_.back();
  TrackedKeyframe tracked{.T_map_base = keyframe.T_map_base,
                          .follows_interruption = update.keyframe == KeyframeReason::kInterruption,
                          .is_level = is_planar(keyframe.cloud->T_odom_base) &&
                                      is_level(keyframe.T_map_base, params_.odometry)};
  if (update.registration) {
    tracked.information = update.covariance.inverse();
  }
  if (const auto T_map_keyframes = back_end_.add_keyframe(tracked, sweep, map_)) {
    move_keyframes(*T_map_keyframes);
    update.T_map_base = keyframe.T_map_base;
    update.T_map_odom = T_map_odom_;
  }
}

void Slam6d::polish() {
  if (back_end_.has_loops()) {
    move_keyframes(back_end_.polish());
  }
}

void Slam6d::move_keyframes(std::span<const SE3> T_map_keyframes) {
  const SE3 T_new_old = normalized(T_map_keyframes.back() * keyframes_.back().T_map_base.inverse());
  std::vector<CorrectedPoses::Correction> corrections;
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    keyframes_[k].T_map_base = T_map_keyframes[k];
    corrections.push_back({keyframes_[k].sweep, T_map_keyframes[k]});
  }
  corrected_.move(corrections);
  T_map_odom_ = normalized(T_new_old * T_map_odom_);
  T_map_end_ = normalized(T_new_old * T_map_end_);
  end_covariance_ = rotated(end_covariance_, T_new_old.linear());
  if (last_nod_) {
    last_nod_->T_map_base = normalized(T_new_old * last_nod_->T_map_base);
  }
}

}  // namespace nodmap::slam6d
