// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/submap_chain.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "common/registration/pose_edges.hpp"
#include "modules/slam2d/back_end/line_adjustment.hpp"
#include "modules/slam2d/back_end/wheel_errors.hpp"

namespace nodmap::slam2d {
namespace {

using registration::PoseEdge2d;

// Both ends of a step are matched against the same submap, so most of their errors are the same.
// With this factor the standard deviation over half a submap is twice that of one match. It holds
// for keyframes this far apart; a longer step shows as much new as several of these.
constexpr double kStepInformationFactor = 5.0;
constexpr double kStepDistanceM = 0.3;
constexpr double kStepRotationRad = geometry::deg_to_rad(15.0);

// Steps that all lines have adjusted have a third of the standard deviation of others.
constexpr double kAdjustedFactor = 10.0;
constexpr double kRounding = 1e-9;  // relative, of a difference

// Added to each step over dropped keyframes; equals a standard deviation of 1 km. Such a step may
// be so long and uncertain, because the robot was lost on it, that composed() counts it as unknown.
constexpr double kMinStepInformation = 1e-6;

// The information of a step that all lines have adjusted. What odometry knows remains as it was. A
// step over dropped keyframes may be less certain than odometry, and stays so.
Eigen::Matrix3d adjusted_information(const Eigen::Matrix3d& step, const Eigen::Matrix3d& odometry) {
  const Eigen::Matrix3d by_matches = step - odometry;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(by_matches, Eigen::EigenvaluesOnly);
  const bool is_surer = solver.eigenvalues()[0] >= -kRounding * step.trace();
  return is_surer ? Eigen::Matrix3d(step + (kAdjustedFactor - 1.0) * by_matches) : step;
}

double information_factor(const geometry::SE2& step) {
  const double num_steps = std::floor(
      std::max(std::hypot(step.x, step.y) / kStepDistanceM, std::abs(step.yaw) / kStepRotationRad));
  return kStepInformationFactor / std::max(1.0, num_steps);
}

}  // namespace

SubmapChain::SubmapChain(const SubmapParams& params, const MapParams& map)
    : params_(params), map_params_(map) {}

void SubmapChain::save(SavedMap& map) const {
  map.keyframes = keyframes_;
  map.steps = steps_;
  for (const Submap& submap : submaps_) {
    map.submaps.push_back({submap.first_keyframe, submap.end_keyframe()});
  }
}

void SubmapChain::restore(SavedMap map) {
  is_beginning_straight_ = true;  // since the end of the drive that began it
  keyframes_ = std::move(map.keyframes);
  steps_ = std::move(map.steps);
  for (const SavedMap::Submap& submap : map.submaps) {
    submap_of_.resize(submap.end_keyframe, submaps_.size());
    submaps_.push_back(build_submap(submap.first_keyframe, submap.end_keyframe));
  }
}

void SubmapChain::begin_anew(const Eigen::Vector3d& sigmas) {
  local_ = submaps_.size();
  num_separate_ = submaps_.size();
  begin_sigmas_ = sigmas;
}

std::size_t SubmapChain::num_points() const {
  std::size_t sum = 0;
  for (const Submap& submap : submaps_) {
    sum += submap.points.points().size();
  }
  return sum;
}

bool SubmapChain::is_full(const Submap& submap, double ratio) const {
  return static_cast<double>(submap.T_submap_keyframe.size()) >= ratio * params_.num_keyframes;
}

bool SubmapChain::add(Keyframe keyframe, const geometry::SE2& T_local_keyframe,
                      const Eigen::Matrix3d& information) {
  const std::size_t added = keyframes_.size();
  keyframes_.push_back(std::move(keyframe));
  submap_of_.push_back(local_);
  if (!has_local()) {
    begin_local();
  } else {
    keyframes_[added].T_map_base = submaps_[local_].T_map_submap * T_local_keyframe;
    add_step(added, T_local_keyframe, information);
    insert_into_submaps(T_local_keyframe);
  }
  const bool is_finished = is_full(submaps_[local_], 1.0);
  local_ += is_finished ? 1 : 0;
  return is_finished;
}

void SubmapChain::begin_local() {
  const std::size_t added = keyframes_.size() - 1;
  const Keyframe& keyframe = keyframes_[added];
  if (added > 0) {
    PoseEdge2d edge;
    edge.from = added - 1;
    edge.to = added;
    edge.T_from_to = keyframes_[added - 1].T_map_base.inverse() * keyframe.T_map_base;
    edge.information = begin_sigmas_.cwiseAbs2().cwiseInverse().asDiagonal();
    steps_.push_back(edge);
  }
  submaps_.emplace_back(added, keyframe.T_map_base, map_params_);
  submaps_.back().add({}, oriented_points(keyframe));
}

// Poses within a submap depend on the match alone, not on how the graph moves the submap.
void SubmapChain::insert_into_submaps(const geometry::SE2& T_local_keyframe) {
  const std::size_t added = keyframes_.size() - 1;
  const std::vector<OrientedPoint> points = oriented_points(keyframes_[added]);
  submaps_[local_].add(T_local_keyframe, points);
  if (submaps_.size() == local_ + 1 && is_full(submaps_[local_], 0.5)) {
    submaps_.emplace_back(added, keyframes_[added].T_map_base, map_params_);
    submaps_.back().add({}, points);
  } else if (submaps_.size() > local_ + 1) {
    Submap& next = submaps_[local_ + 1];
    const geometry::SE2& T_local_next = submaps_[local_].pose_of(next.first_keyframe);
    next.add(T_local_next.inverse() * T_local_keyframe, points);
  }
}

Eigen::Matrix3d SubmapChain::odometry_information_on_step(std::size_t to) const {
  return odometry_information(keyframes_[to - 1].T_odom_base.inverse() *
                              keyframes_[to].T_odom_base);
}

void SubmapChain::add_step(std::size_t keyframe, const geometry::SE2& T_local_keyframe,
                           const Eigen::Matrix3d& information) {
  const geometry::SE2& T_local_last = submaps_[local_].pose_of(keyframe - 1);
  PoseEdge2d edge;
  edge.from = keyframe - 1;
  edge.to = keyframe;
  edge.T_from_to = T_local_last.inverse() * T_local_keyframe;
  edge.information =
      information_factor(edge.T_from_to) * registration::rotated(information, -T_local_last.yaw) +
      odometry_information_on_step(keyframe);
  steps_.push_back(edge);
}

PoseEdge2d SubmapChain::step_to_submap(std::size_t submap) const {
  const Submap& from = submaps_[submap - 1];
  PoseEdge2d edge;
  edge.from = submap - 1;
  edge.to = submap;
  // A submap that begins anew shares no keyframe with the last.
  const auto pose_in_from = [this, &from](std::size_t k) {
    return from.has(k) ? from.pose_of(k) : from.pose_of(k - 1) * steps_[k - 1].T_from_to;
  };
  edge.T_from_to = pose_in_from(submaps_[submap].first_keyframe);
  // The covariances of the steps between, at the end of their moment arms.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = from.first_keyframe; k < submaps_[submap].first_keyframe; ++k) {
    const Eigen::Vector2d moment_arm =
        edge.T_from_to.translation() - pose_in_from(k + 1).translation();
    const Eigen::Matrix3d J = registration::moment_arm_jacobian(moment_arm);
    const Eigen::Matrix3d step =
        registration::rotated(steps_[k].information.inverse(), from.pose_of(k).yaw);
    covariance += J * step * J.transpose();
  }
  edge.information = covariance.inverse();
  return edge;
}

// The two submaps before the local one are left out: they were built along with it.
std::size_t SubmapChain::end_finished() const {
  return std::max(num_separate_, std::max<std::size_t>(local_, 2) - 2);
}

DroppedKeyframes SubmapChain::drop_submap(std::size_t dropped) {
  // Its neighbours overlap it: only keyframes that are in neither are dropped.
  const std::size_t end_before = dropped > 0 ? submaps_[dropped - 1].end_keyframe() : 0;
  const std::size_t first = std::max(submaps_[dropped].first_keyframe, end_before);
  const std::size_t end = std::max(
      first, std::min(submaps_[dropped].end_keyframe(), submaps_[dropped + 1].first_keyframe));
  for (std::size_t k = submaps_[dropped].first_keyframe; k < submap_of_.size(); ++k) {
    const bool goes_to_next = submap_of_[k] == dropped && submaps_[dropped + 1].has(k);
    if (submap_of_[k] > 0 && submap_of_[k] >= dropped && !goes_to_next) {
      --submap_of_[k];
    }
  }
  DroppedKeyframes dropped_keyframes = drop_keyframes(first, end);
  submaps_.erase(submaps_.begin() + static_cast<std::ptrdiff_t>(dropped));
  for (std::size_t s = dropped; s < submaps_.size(); ++s) {
    submaps_[s].first_keyframe -= end - first;
  }
  move_keyframes();
  --local_;
  num_separate_ -= dropped < num_separate_ ? 1 : 0;
  return dropped_keyframes;
}

DroppedKeyframes SubmapChain::drop_keyframes(std::size_t first, std::size_t end) {
  const auto at = [](auto& values, std::size_t index) {
    return values.begin() + static_cast<std::ptrdiff_t>(index);
  };
  // The steps over the gap become one.
  for (std::size_t k = first; first > 0 && k < end; ++k) {
    steps_[first - 1] = composed(steps_[first - 1], steps_[k]);
    steps_[first - 1].information.diagonal().array() += kMinStepInformation;
  }
  steps_.erase(at(steps_, first), at(steps_, end));
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    steps_[k].from = k;
    steps_[k].to = k + 1;
  }
  DroppedKeyframes dropped{first,
                           {std::make_move_iterator(at(keyframes_, first)),
                            std::make_move_iterator(at(keyframes_, end))}};
  keyframes_.erase(at(keyframes_, first), at(keyframes_, end));
  submap_of_.erase(at(submap_of_, first), at(submap_of_, end));
  return dropped;
}

void SubmapChain::move_submaps(std::span<const geometry::SE2> T_map_submaps) {
  for (std::size_t s = 0; s < submaps_.size(); ++s) {
    submaps_[s].T_map_submap = T_map_submaps[s];
  }
  move_keyframes();
}

void SubmapChain::move_keyframes() {
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    const Submap& submap = submaps_[submap_of_[k]];
    keyframes_[k].T_map_base = submap.T_map_submap * submap.pose_of(k);
  }
}

void SubmapChain::set_poses(std::span<const geometry::SE2> T_map_keyframe) {
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    keyframes_[k].T_map_base = T_map_keyframe[k];
  }
}

// Up to where the drive was interrupted: beyond a step that even odometry would have told better,
// the pose may be wrong by more than lines can mend.
std::size_t SubmapChain::end_of_beginning() const {
  const std::size_t end =
      std::min(keyframes_.size(), std::size_t{2} * static_cast<std::size_t>(params_.num_keyframes));
  const auto is_surer_by_odometry = [this](std::size_t to) {
    const Eigen::Array3d known = steps_[to - 1].information.diagonal();
    return (known < 0.5 * odometry_information_on_step(to).diagonal().array()).any();
  };
  std::size_t k = 1;
  while (k < end && !is_surer_by_odometry(k)) {
    ++k;
  }
  return std::min(k, end);
}

bool SubmapChain::straighten_beginning() {
  if (std::exchange(is_beginning_straight_, true)) {
    return false;
  }
  const std::size_t end = end_of_beginning();
  const std::vector<geometry::SE2> T_map_keyframe =
      adjusted_to_lines(std::span(keyframes_).first(end), map_params_);
  for (std::size_t k = 0; k < end; ++k) {
    keyframes_[k].T_map_base = T_map_keyframe[k];
  }
  for (std::size_t k = 1; k < end; ++k) {
    PoseEdge2d& step = steps_[k - 1];
    step.T_from_to = T_map_keyframe[k - 1].inverse() * T_map_keyframe[k];
    step.information = adjusted_information(step.information, odometry_information_on_step(k));
  }
  for (Submap& submap : submaps_) {
    if (submap.end_keyframe() <= end) {
      submap = build_submap(submap.first_keyframe, submap.end_keyframe());
    }
  }
  return true;
}

void SubmapChain::rebuild_submaps() {
  for (Submap& submap : submaps_) {
    submap = build_submap(submap.first_keyframe, submap.end_keyframe());
  }
}

Submap SubmapChain::build_submap(std::size_t first_keyframe, std::size_t end_keyframe) const {
  Submap submap(first_keyframe, keyframes_[first_keyframe].T_map_base, map_params_);
  for (std::size_t k = first_keyframe; k < end_keyframe; ++k) {
    submap.add(submap.T_map_submap.inverse() * keyframes_[k].T_map_base,
               oriented_points(keyframes_[k]));
  }
  return submap;
}

}  // namespace nodmap::slam2d
