// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/slam6d.hpp"

#include <cmath>
#include <utility>

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// Odometry is kept as long as a sweep may last, at 10 scans a second (the slowest device known).
std::int64_t history_span_us(const Slam6dParams& params) {
  return std::int64_t{100'000} * (params.max_scans + 1);
}

constexpr std::int64_t kMaxExtrapolationUs = 50'000;

// Within a sweep. A tenth of the scanner's noise, near as well as at 10 m; more than wheels that
// are held report.
constexpr double kStandingM = 1e-3;
constexpr double kStandingRad = 1e-4;

SweepSegmenter::Options segmenter_options(const Slam6dParams& params) {
  return {.reversal_hysteresis_rad = params.reversal_hysteresis_rad,
          .jump_back_rad = params.jump_back_rad,
          .gap_us = std::llround(params.gap_s * 1e6),
          .max_scans = static_cast<std::size_t>(params.max_scans)};
}

SurfaceOptions surface_options(const Slam6dParams& params) {
  return {.point_spacing_m = params.point_spacing_m,
          .plane_neighbours = static_cast<std::size_t>(params.plane_neighbours),
          .plane_radius_m = params.plane_radius_m};
}

RegistrationOptions registration_options(const Slam6dParams& params) {
  return {.metric = params.metric,
          .max_correspondence_m = params.max_correspondence_m,
          .min_correspondence_m = params.min_correspondence_m,
          .residual_scale_m = params.residual_scale_m,
          .min_constraint = params.min_constraint,
          .min_match_share = params.min_match_share,
          .iterations = params.iterations,
          .ground_weight = params.ground_weight};
}

Surface extract_surface(const SweepCloud& cloud, const Slam6dParams& params) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(cloud.points.size());
  for (const Eigen::Vector3f& p : cloud.points) {
    points.emplace_back(p.cast<double>());
  }
  // The mirror moves little within a sweep: its middle place tells the two sides of a wall apart.
  const Eigen::Vector3d p_base_view =
      cloud.lines.empty()
          ? Eigen::Vector3d::Zero()
          : Eigen::Vector3d(cloud.lines[cloud.lines.size() / 2].p_base_mirror.cast<double>());
  return extract_surface(points, p_base_view, surface_options(params));
}

}  // namespace

Slam6d::Slam6d(const Slam6dParams& params)
    : params_(params),
      segmenter_(segmenter_options(params)),
      odometry_(history_span_us(params), kMaxExtrapolationUs),
      model_(params.point_spacing_m) {}

bool Slam6d::add_odometry(std::int64_t utime_us, const SE3& T_odom_base) {
  return odometry_.add(utime_us, T_odom_base);
}

std::optional<SweepRecord> Slam6d::change_odometry_frame(const SE3& T_new_odom_base) {
  auto record = flush();
  if (const auto T_old_odom_base = odometry_.newest()) {
    const SE3 T_old_new = *T_old_odom_base * T_new_odom_base.inverse();
    T_map_odom_ = T_map_odom_ * T_old_new;
    T_first_odom_ = T_first_odom_ * T_old_new;
    interrupted_ = true;
  }
  odometry_.clear();
  return record;
}

// IV B: "segment the continuous data flow to reflect one complete pitch movement per point cloud".
std::optional<SweepRecord> Slam6d::add_scan(scan::Scan scan) {
  const auto sweep = segmenter_.add(std::move(scan));
  return sweep ? process(*sweep) : std::nullopt;
}

std::optional<SweepRecord> Slam6d::flush() {
  const auto sweep = segmenter_.flush();
  return sweep ? process(*sweep) : std::nullopt;
}

// IV B: "the robot's movement [...] during the pitching movement is stripped from the point cloud".
std::optional<SweepRecord> Slam6d::process(const Sweep& sweep) {
  const auto pose_at = [this](std::int64_t utime_us) -> std::optional<SE3> {
    if (odometry_.empty() && params_.assume_standing) {
      return SE3::Identity();
    }
    return odometry_.at(utime_us);
  };
  scans_in_sweeps_ += sweep.scans.size();
  interrupted_ = interrupted_ || sweep.follows_interruption;
  auto cloud = strip_motion(sweep.scans, pose_at, {params_.min_range_m, params_.max_range_m});
  if (!cloud) {
    scans_without_pose_ += sweep.scans.size();
    return std::nullopt;
  }
  scans_without_pose_ += cloud->scans_without_pose;
  return add_cloud(std::move(*cloud));
}

SweepRecord Slam6d::add_cloud(SweepCloud cloud) {
  SweepRecord record{.utime_us = cloud.utime_us,
                     .T_odom_base = cloud.T_odom_base,
                     .T_first_odom = T_first_odom_,
                     .scans_used = cloud.scans_used,
                     .scans_without_pose = cloud.scans_without_pose,
                     .num_points = cloud.points.size(),
                     .stood = cloud.moved_m < kStandingM && cloud.turned_rad < kStandingRad};
  // Reference [5]: odometry's motion since the last registered pose, in that pose's frame:
  // P_n+1 = P_n (odo_n^-1 odo_n+1).
  record.T_map_base = T_map_odom_ * record.T_odom_base;
  if (!keyframes_.empty()) {
    const SE3 moved = keyframes_.back().T_map_base.inverse() * record.T_map_base;
    record.moved_m = moved.translation().norm();
    record.turned_rad = geometry::rotation_angle(moved);
  }
  record.keyframe = keyframe_reason(record);
  if (record.keyframe) {
    make_keyframe(record, std::move(cloud));
  }
  sweeps_.push_back(record);
  return record;
}

// IV B: "only those whose robot base poses P_b are further than 2 m away from each other or that
// correspond to a rotation of more than 45 deg". Odometry is not trusted over an interruption.
std::optional<KeyframeReason> Slam6d::keyframe_reason(const SweepRecord& record) const {
  if (record.num_points == 0 || record.scans_used < static_cast<std::size_t>(params_.min_scans)) {
    return std::nullopt;
  }
  if (params_.standing_only && !record.stood) {
    return std::nullopt;
  }
  if (keyframes_.empty()) {
    return KeyframeReason::kFirst;
  }
  if (interrupted_) {
    return KeyframeReason::kInterruption;
  }
  if (record.moved_m > params_.keyframe_distance_m) {
    return KeyframeReason::kDistance;
  }
  if (record.turned_rad > params_.keyframe_rotation_rad) {
    return KeyframeReason::kRotation;
  }
  return std::nullopt;
}

// IV B: "registered into an incrementally built 3D model"; IV: "the same transformation can be
// applied [...] to correct the former pose estimation obtained via odometry".
void Slam6d::make_keyframe(SweepRecord& record, SweepCloud cloud) {
  Surface surface = extract_surface(cloud, params_);
  if (!keyframes_.empty()) {
    record.registration =
        register_surface(surface, model_, record.T_map_base, registration_options(params_));
    record.T_map_base = record.registration->T_map_base;
    T_map_odom_ = record.T_map_base * record.T_odom_base.inverse();
  }
  model_.add(surface, record.T_map_base);
  keyframes_.push_back({sweeps_.size(), record.T_map_base, std::move(cloud), std::move(surface)});
  interrupted_ = false;
}

std::vector<SE3> Slam6d::trajectory() const {
  const auto first_base = [this](std::size_t i) -> SE3 {
    return sweeps_[i].T_first_odom * sweeps_[i].T_odom_base;
  };
  std::vector<SE3> poses;
  poses.reserve(sweeps_.size());
  for (const SweepRecord& sweep : sweeps_) {
    poses.push_back(sweep.T_map_base);
  }
  for (std::size_t k = 1; k < keyframes_.size(); ++k) {
    const std::size_t first = keyframes_[k - 1].sweep;
    const std::size_t last = keyframes_[k].sweep;
    // What the registration of the later keyframe put right, in its base frame.
    const SE3 T_map_first = keyframes_[k - 1].T_map_base * first_base(first).inverse();
    const SE3 correction = (T_map_first * first_base(last)).inverse() * keyframes_[k].T_map_base;
    for (std::size_t i = first; i <= last; ++i) {
      const double fraction = static_cast<double>(i - first) / static_cast<double>(last - first);
      poses[i] = T_map_first * first_base(i) *
                 geometry::interpolate(SE3::Identity(), correction, fraction);
    }
  }
  return poses;
}

}  // namespace nodmap::slam6d
