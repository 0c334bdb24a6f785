// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/trajectory_error.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace nodmap::evaluate {
namespace {

using formats::StampedPose;

// The true pose at a time, if a sample is close enough.
std::optional<geometry::SE3> pose_at(const formats::Trajectory& truth, time::Timestamp stamp,
                                     time::Duration tolerance) {
  const auto after = std::ranges::lower_bound(truth, stamp, {}, &StampedPose::stamp);
  const bool close_after = after != truth.end() && after->stamp - stamp <= tolerance;
  if (close_after && after->stamp == stamp) {
    return after->pose;
  }
  const bool close_before = after != truth.begin() && stamp - std::prev(after)->stamp <= tolerance;
  if (!close_after && !close_before) {
    return std::nullopt;
  }
  if (after == truth.end()) {
    return std::prev(after)->pose;
  }
  if (after == truth.begin()) {
    return after->pose;
  }
  const StampedPose& before = *std::prev(after);
  const double fraction = time::ratio(stamp - before.stamp, after->stamp - before.stamp);
  return geometry::interpolate(before.pose, after->pose, fraction);
}

geometry::SE3 align_first_pose(const std::vector<PosePair>& pairs) {
  return pairs.front().T_truth_base * pairs.front().T_map_base.inverse();
}

// Whether noise could decide the rotation about a path, because it departs from a straight line by
// less than a hundredth of its length.
bool is_straight(const Eigen::Matrix3Xd& p) {
  const Eigen::Matrix3Xd centred = p.colwise() - p.rowwise().mean();
  const Eigen::Vector3d spread =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(centred * centred.transpose()).eigenvalues();
  return spread(1) < 1e-4 * spread(2);
}

// The motion of a straight path is looked for in the plane only: its vertical axis is known.
geometry::SE3 align_least_squares(const std::vector<PosePair>& pairs) {
  const auto n = static_cast<Eigen::Index>(pairs.size());
  Eigen::Matrix3Xd p_map(3, n);
  Eigen::Matrix3Xd p_truth(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const PosePair& pair = pairs[static_cast<std::size_t>(i)];
    p_map.col(i) = pair.T_map_base.translation();
    p_truth.col(i) = pair.T_truth_base.translation();
  }
  if (!is_straight(p_map) && !is_straight(p_truth)) {
    return geometry::SE3(Eigen::umeyama(p_map, p_truth, false));
  }
  const Eigen::Vector3d mean_map = p_map.rowwise().mean();
  const Eigen::Vector3d mean_truth = p_truth.rowwise().mean();
  const Eigen::Matrix3d cross =
      (p_truth.colwise() - mean_truth) * (p_map.colwise() - mean_map).transpose();
  const double yaw = std::atan2(cross(1, 0) - cross(0, 1), cross(0, 0) + cross(1, 1));
  geometry::SE3 T_truth_map(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  T_truth_map.translation() = mean_truth - T_truth_map.linear() * mean_map;
  return T_truth_map;
}

// How far each sample is along the path, from the first one.
std::vector<double> lengths_m(const formats::Trajectory& truth) {
  std::vector<double> lengths_m;
  double length_m = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    length_m += i == 0 ? 0.0 : geometry::distance_m(truth[i - 1].pose, truth[i].pose);
    lengths_m.push_back(length_m);
  }
  return lengths_m;
}

// The same at a time at which the robot was at `pose`.
double length_at(const formats::Trajectory& truth, const std::vector<double>& lengths_m,
                 time::Timestamp stamp, const geometry::SE3& pose) {
  const auto after = std::ranges::lower_bound(truth, stamp, {}, &StampedPose::stamp);
  if (after == truth.begin()) {
    return 0.0;
  }
  const auto before = std::prev(after);
  return lengths_m[static_cast<std::size_t>(before - truth.begin())] +
         geometry::distance_m(before->pose, pose);
}

}  // namespace

std::vector<PosePair> associate(const formats::Trajectory& estimate, formats::Trajectory truth,
                                time::Duration tolerance) {
  std::ranges::stable_sort(truth, {}, &StampedPose::stamp);
  const std::vector<double> path_m = lengths_m(truth);
  std::vector<PosePair> pairs;
  for (const StampedPose& stamped : estimate) {
    if (const auto true_pose = pose_at(truth, stamped.stamp, tolerance)) {
      pairs.push_back(
          {stamped.pose, *true_pose, length_at(truth, path_m, stamped.stamp, *true_pose)});
    }
  }
  return pairs;
}

double longest_gap_s(const formats::Trajectory& estimate, const formats::Trajectory& truth) {
  const auto [first, last] = std::ranges::minmax_element(truth, {}, &StampedPose::stamp);
  std::vector<time::Timestamp> stamps{first->stamp, last->stamp};
  for (const StampedPose& pose : estimate) {
    stamps.push_back(std::clamp(pose.stamp, first->stamp, last->stamp));
  }
  std::ranges::sort(stamps);
  time::Duration longest{};
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    longest = std::max(longest, stamps[i] - stamps[i - 1]);
  }
  return time::seconds(longest);
}

TrajectoryErrors measure_trajectory(const std::vector<PosePair>& pairs, Alignment alignment) {
  TrajectoryErrors errors;
  errors.n = pairs.size();
  if (pairs.empty()) {
    return errors;
  }
  const geometry::SE3 T_truth_map =
      alignment == Alignment::kFirstPose ? align_first_pose(pairs) : align_least_squares(pairs);
  double sum_m2 = 0.0;
  double sum_rad2 = 0.0;
  for (const PosePair& pair : pairs) {
    const geometry::SE3 aligned = T_truth_map * pair.T_map_base;
    const double trans_m = (aligned.translation() - pair.T_truth_base.translation()).norm();
    const double rot_rad = geometry::rotation_angle(pair.T_truth_base.inverse() * aligned);
    sum_m2 += trans_m * trans_m;
    sum_rad2 += rot_rad * rot_rad;
    errors.ate_max_m = std::max(errors.ate_max_m, trans_m);
  }
  const auto n = static_cast<double>(pairs.size());
  errors.ate_rmse_m = std::sqrt(sum_m2 / n);
  errors.rot_rmse_rad = std::sqrt(sum_rad2 / n);
  const geometry::SE3 end_error =
      pairs.back().T_truth_base.inverse() * align_first_pose(pairs) * pairs.back().T_map_base;
  errors.end_error_m = end_error.translation().norm();
  errors.end_rot_rad = geometry::rotation_angle(end_error);
  const double length_m = pairs.back().true_path_m - pairs.front().true_path_m;
  if (length_m > 0.0) {
    errors.drift_percent = 100.0 * errors.end_error_m / length_m;
  }
  return errors;
}

}  // namespace nodmap::evaluate
