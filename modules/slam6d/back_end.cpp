// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

constexpr double kSigmas = 3.0;
// What was driven so recently is in the map: the drift since then is in its walls already.
constexpr double kRecentM = 40.0;
// Farther apart than this by the drift, two walls would be entered for one.
constexpr double kCertainM = 0.1;
constexpr double kCertainRad = geometry::deg_to_rad(1.0);
// Voxels are exchanged with the old map when there are so many keyframes to be exchanged, or one
// that is within reach of the scanner.
constexpr std::ptrdiff_t kExchangedAtOnce = 10;
constexpr double kWithinReachM = 20.0;
// A smaller change of the poses waits for the next.
constexpr double kMinCorrectionM = 0.005;
// Both ends of a step are matched against the same map, and most of their errors are alike.
constexpr double kStepInformationFactor = 5.0;

double distance(const SE3& a, const SE3& b) {
  return (a.translation() - b.translation()).norm();
}

bool is_certain(const Matrix6d& covariance) {
  return kSigmas * std::sqrt(covariance.diagonal().head<3>().maxCoeff()) < kCertainM &&
         kSigmas * std::sqrt(covariance.diagonal().tail<3>().maxCoeff()) < kCertainRad;
}

}  // namespace

BackEnd::BackEnd(const LoopParams& loops, const RegistrationParams& registration,
                 const OdometryParams& odometry, const VoxelMapParams& voxels)
    : params_(loops),
      odometry_(odometry),
      voxels_(voxels),
      closer_(loops, registration),
      graph_({odometry.level_height_m, odometry.level_tilt_rad}),
      old_map_(voxels) {}

std::optional<std::vector<SE3>> BackEnd::add_keyframe(const TrackedKeyframe& keyframe,
                                                      const VoxelMap& sweep_base, VoxelMap& map) {
  add_step(keyframe);
  uncertainty_ = graph_.uncertainties(T_map_keyframes_, newest());
  tie_to_map(keyframe);
  std::vector<SE3> moved = T_map_keyframes_;
  if (close_loops(sweep_base)) {
    moved = optimise();
    uncertainty_ = graph_.uncertainties(moved, newest());
  }
  double largest_m = 0.0;
  for (std::size_t k = 0; k < moved.size(); ++k) {
    largest_m = std::max(largest_m, distance(moved[k], T_map_keyframes_[k]));
  }
  const bool is_moved = largest_m > kMinCorrectionM;
  std::vector<bool> certain = certain_keyframes();
  if (is_moved) {
    ++metrics_.corrections;
    metrics_.largest_correction_m =
        std::max(metrics_.largest_correction_m, distance(moved.back(), T_map_keyframes_.back()));
    arrange(map, moved, std::move(certain));
    return T_map_keyframes_;
  }
  if (is_outdated(certain)) {
    arrange(map, T_map_keyframes_, std::move(certain));
  }
  return std::nullopt;
}

std::vector<SE3> BackEnd::optimise() {
  return graph_.optimise(T_map_keyframes_, std::exchange(has_searched_loops_, false));
}

void BackEnd::add_loop(const Loop& loop) {
  graph_.add_loop({.from = loop.from,
                   .to = loop.to,
                   .T_from_to = loop.T_from_to,
                   .information = loop.information,
                   .may_be_wrong = true});
}

// The edge from the last keyframe to this one.
void BackEnd::add_step(const TrackedKeyframe& keyframe) {
  T_map_keyframes_.push_back(keyframe.T_map_base);
  is_in_map_.push_back(true);
  graph_.add_keyframe(keyframe.is_level);
  if (newest() == 0) {
    path_m_.push_back(0.0);
    return;
  }
  const SE3& T_map_last = T_map_keyframes_[newest() - 1];
  const SE3 T_last_this = T_map_last.inverse() * keyframe.T_map_base;
  const OdometryMotion motion{.distance_m = T_last_this.translation().norm(),
                              .rotation_rad = geometry::rotation_angle(T_last_this),
                              .is_interrupted = keyframe.follows_interruption};
  graph_.add_step(
      {.from = newest() - 1,
       .to = newest(),
       .T_from_to = T_last_this,
       .information = rotated(kStepInformationFactor * keyframe.information +
                                  odometry_covariance(T_map_last, motion, odometry_).inverse(),
                              T_map_last.linear().transpose())});
  path_m_.push_back(path_m_.back() + motion.distance_m);
}

// Where the map against which the keyframe was registered is of a place of before, this was a loop
// closure: whatever moves later, the two stay together.
void BackEnd::tie_to_map(const TrackedKeyframe& keyframe) {
  const auto nearest = nearest_keyframe(false);
  if (!nearest || keyframe.information.isZero(0.0)) {
    return;
  }
  const SE3& T_map_nearest = T_map_keyframes_[*nearest];
  add_loop({.from = *nearest,
            .to = newest(),
            .T_from_to = T_map_nearest.inverse() * keyframe.T_map_base,
            .information = rotated(keyframe.information, T_map_nearest.linear().transpose())});
}

// The nearest of those that were driven before, in the old map or in the one that is registered
// against, if it may be within the distance of a loop.
std::optional<std::size_t> BackEnd::nearest_keyframe(bool is_old) const {
  std::optional<std::size_t> nearest;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < newest(); ++k) {
    const double distance_m = distance(T_map_keyframes_[k], T_map_keyframes_.back());
    if (is_in_map_[k] == is_old || path_m_[k] > path_m_.back() - kRecentM ||
        distance_m >= nearest_m) {
      continue;
    }
    const auto variance = uncertainty_[k].diagonal();
    const double drift_m = kSigmas * std::sqrt(std::max(variance[0], variance[1]));
    if (distance_m < params_.max_distance_m + std::min(drift_m, params_.max_search_m)) {
      nearest = k;
      nearest_m = distance_m;
    }
  }
  return nearest;
}

// Returns whether there are new loops.
bool BackEnd::close_loops(const VoxelMap& sweep_base) {
  const auto nearest = nearest_keyframe(true);
  if (!nearest) {
    return false;
  }
  const SE3& T_map_old = T_map_keyframes_[*nearest];
  const SE3& T_map_base = T_map_keyframes_.back();
  // The same relative pose, seen from its other end.
  const Matrix6d J = moment_arm_jacobian(T_map_base.translation() - T_map_old.translation());
  const PosePrior prior{
      .T_map_base = T_map_base,
      .covariance = J * uncertainty_[*nearest] * J.transpose() + 1e-8 * Matrix6d::Identity()};
  const bool is_search = LoopCloser::needs_search(prior);
  metrics_.searches += is_search ? 1 : 0;
  VoxelMap sweep = sweep_base;
  sweep.hold();
  LoopAttempt attempt = closer_.match(sweep, old_map_, prior);
  if (!attempt.loop) {
    ++(attempt.refusal == LoopRefusal::kAmbiguous ? metrics_.refused_ambiguous
                                                  : metrics_.refused_match);
    return false;
  }
  Loop& loop = *attempt.loop;
  loop.from = *nearest;
  loop.to = newest();
  loop.T_from_to = T_map_old.inverse() * loop.T_from_to;
  loop.information = rotated(loop.information, T_map_old.linear().transpose());
  std::vector<Loop> accepted{loop};
  if (is_search) {
    accepted = closer_.add_pending(loop, T_map_keyframes_);
    has_searched_loops_ = has_searched_loops_ || !accepted.empty();
  }
  (is_search ? metrics_.loops_searched : metrics_.loops_tracked) +=
      static_cast<std::int64_t>(accepted.size());
  for (const Loop& one : accepted) {
    add_loop(one);
  }
  return !accepted.empty();
}

std::vector<bool> BackEnd::certain_keyframes() const {
  std::vector<bool> certain(T_map_keyframes_.size());
  for (std::size_t k = 0; k < certain.size(); ++k) {
    certain[k] = path_m_.back() - path_m_[k] < kRecentM || is_certain(uncertainty_[k]);
  }
  return certain;
}

bool BackEnd::is_outdated(const std::vector<bool>& certain) const {
  std::ptrdiff_t exchanged = 0;
  for (std::size_t k = 0; k < certain.size(); ++k) {
    if (certain[k] != is_in_map_[k]) {
      ++exchanged;
      if (distance(T_map_keyframes_[k], T_map_keyframes_.back()) < kWithinReachM) {
        return true;
      }
    }
  }
  return exchanged >= kExchangedAtOnce;
}

// Moves voxels with their keyframes, and exchanges them between the two maps.
void BackEnd::arrange(VoxelMap& map, std::span<const SE3> T_map_moved, std::vector<bool> certain) {
  ++metrics_.maps_arranged;
  std::vector<SE3> motions;
  for (std::size_t k = 0; k < T_map_moved.size(); ++k) {
    motions.push_back(T_map_moved[k] * T_map_keyframes_[k].inverse());
  }
  std::vector<bool> uncertain = certain;
  uncertain.flip();
  VoxelMap present(voxels_);
  VoxelMap old(voxels_);
  for (const VoxelMap* part : {&std::as_const(old_map_), &std::as_const(map)}) {
    present.add_keyframes(*part, motions, certain);
    old.add_keyframes(*part, motions, uncertain);
  }
  map = std::move(present);
  old_map_ = std::move(old);
  is_in_map_ = std::move(certain);
  T_map_keyframes_.assign(T_map_moved.begin(), T_map_moved.end());
}

}  // namespace nodmap::slam6d
