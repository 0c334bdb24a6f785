// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/back_end.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/registration/pose_edges.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::distance_m;
using geometry::SE3;
using registration::moment_arm_jacobian;
using registration::rotated;

// Voxels are exchanged with the old map once they belong to this many keyframes, or to one within
// reach of the scanner.
constexpr std::ptrdiff_t kExchangedAtOnce = 10;
constexpr double kWithinReachM = 20.0;
// Smaller changes of the poses are not applied yet.
constexpr double kMinCorrectionM = 0.005;
// Both ends of a step are matched against the same map, so most of their errors are the same.
constexpr double kStepInformationFactor = 5.0;

bool is_certain(const Matrix6d& covariance, const LoopParams& params) {
  return kReachSigmas * std::sqrt(covariance.diagonal().head<3>().maxCoeff()) < params.certain_m &&
         kReachSigmas * std::sqrt(covariance.diagonal().tail<3>().maxCoeff()) < params.certain_rad;
}

}  // namespace

BackEnd::BackEnd(const LoopParams& loops, const RegistrationParams& registration,
                 const OdometryParams& odometry, const VoxelMapParams& voxels)
    : params_(loops),
      odometry_(odometry),
      voxels_(voxels),
      closer_(loops, registration),
      graph_(odometry.level_ground()),
      old_map_(voxels) {}

void BackEnd::restore(const SavedMap& saved) {
  for (const SavedMap::Keyframe& keyframe : saved.keyframes) {
    T_map_keyframes_.push_back(keyframe.T_map_base);
    graph_.add_keyframe(keyframe.is_level);
  }
  num_restored_ = T_map_keyframes_.size();
  is_in_map_.assign(num_restored_, true);
  path_m_.assign(num_restored_, -params_.recent_m);  // long ago
  std::ranges::for_each(saved.steps, [this](const auto& step) { graph_.add_step(step); });
  std::ranges::for_each(saved.loops, [this](const auto& loop) { graph_.add_loop(loop); });
  ++graph_revision_;
  (void)graph_.optimise(T_map_keyframes_, false);  // only for what the loops weigh
}

void BackEnd::take_adjusted(std::span<const SE3> T_map_keyframes) {
  T_map_keyframes_.assign(T_map_keyframes.begin(), T_map_keyframes.end());
  graph_.set_steps(T_map_keyframes);
}

SavedMap BackEnd::save(std::span<const Keyframe> keyframes) const {
  SavedMap saved;
  saved.steps.assign(graph_.steps().begin(), graph_.steps().end());
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    saved.keyframes.push_back({.cloud = keyframes[k].cloud,
                               .T_map_base = keyframes[k].T_map_base,
                               .is_level = graph_.is_level(k)});
  }
  for (const KeyframeGraph::WeightedLoop& loop : graph_.loops()) {
    saved.loops.push_back(loop.edge);
  }
  return saved;
}

std::optional<std::vector<SE3>> BackEnd::add_keyframe(const TrackedKeyframe& keyframe,
                                                      const VoxelMap& sweep_base, VoxelMap& map) {
  add_step(keyframe);
  ++graph_revision_;
  if (!params_.enabled) {
    return std::nullopt;
  }
  uncertainty_ = graph_.uncertainties(T_map_keyframes_, newest());
  tie_to_map(keyframe);
  std::vector<SE3> moved = T_map_keyframes_;
  if (close_loops(sweep_base)) {
    moved = optimise();
    uncertainty_ = graph_.uncertainties(moved, newest());
  }
  return correct(moved, map) ? std::optional(T_map_keyframes_) : std::nullopt;
}

// Moves keyframes and voxels to their new poses if the change is large enough. Returns whether the
// keyframes have moved.
bool BackEnd::correct(std::span<const SE3> T_map_moved, VoxelMap& map) {
  double largest_m = 0.0;
  for (std::size_t k = 0; k < T_map_moved.size(); ++k) {
    largest_m = std::max(largest_m, distance_m(T_map_moved[k], T_map_keyframes_[k]));
  }
  std::vector<bool> certain = certain_keyframes();
  if (largest_m > kMinCorrectionM) {
    ++metrics_.corrections;
    metrics_.largest_correction_m = std::max(
        metrics_.largest_correction_m, distance_m(T_map_moved.back(), T_map_keyframes_.back()));
    arrange(map, T_map_moved, std::move(certain));
    return true;
  }
  if (is_outdated(certain)) {
    const std::vector<SE3> unmoved = T_map_keyframes_;
    arrange(map, unmoved, std::move(certain));
  }
  return false;
}

void BackEnd::drop_keyframe(const ReplacedKeyframe& replaced, VoxelMap& map) {
  graph_.drop_keyframe(replaced.index);
  closer_.drop_keyframe(replaced);
  map.drop_keyframe(replaced);
  old_map_.drop_keyframe(replaced);
  const auto erase = [&replaced](auto& values) {
    if (replaced.index < values.size()) {  // without loops there are no uncertainties
      values.erase(values.begin() + static_cast<std::ptrdiff_t>(replaced.index));
    }
  };
  erase(T_map_keyframes_);
  erase(path_m_);
  erase(uncertainty_);
  erase(is_in_map_);
  num_restored_ -= replaced.index < num_restored_ ? 1 : 0;
  std::erase_if(refused_, [&replaced](const RefusedLoop& loop) {
    return loop.from == replaced.index || loop.to == replaced.index;
  });
  for (RefusedLoop& loop : refused_) {
    loop.from = replaced.renumbered(loop.from);
    loop.to = replaced.renumbered(loop.to);
  }
  ++graph_revision_;
  ++metrics_.keyframes_dropped;
}

std::vector<SE3> BackEnd::polish() {
  ++graph_revision_;
  return optimise();
}

std::vector<SE3> BackEnd::optimise() {
  return graph_.optimise(T_map_keyframes_, std::exchange(has_searched_loops_, false));
}

void BackEnd::add_loop(const Loop& loop, std::optional<double> weight) {
  graph_.add_loop({.from = loop.from,
                   .to = loop.to,
                   .T_from_to = loop.T_from_to,
                   .information = loop.information,
                   .may_be_wrong = true},
                  weight);
}

// The edge from the last keyframe to this one.
void BackEnd::add_step(const TrackedKeyframe& keyframe) {
  T_map_keyframes_.push_back(keyframe.T_map_base);
  is_in_map_.push_back(true);
  graph_.add_keyframe(keyframe.is_level);
  if (newest() == num_restored_) {
    path_m_.push_back(0.0);
    join_to_restored(keyframe);
    return;
  }
  const SE3& T_map_last = T_map_keyframes_[newest() - 1];
  const SE3 T_last_this = T_map_last.inverse() * keyframe.T_map_base;
  const OdometryMotion motion{.distance_m = T_last_this.translation().norm(),
                              .rotation_rad = geometry::rotation_angle(T_last_this),
                              .is_interrupted = keyframe.follows_interruption,
                              .scatter = keyframe.odometry_scatter};
  const Matrix6d by_odometry =
      registration::inverse(odometry_covariance(T_map_last, motion, odometry_));
  graph_.add_step(
      {.from = newest() - 1,
       .to = newest(),
       .T_from_to = T_last_this,
       .information = rotated(kStepInformationFactor * keyframe.information + by_odometry,
                              T_map_last.linear().transpose())});
  path_m_.push_back(path_m_.back() + motion.distance_m);
}

// The first keyframe after a restart: the motion from the last saved keyframe is unknown.
void BackEnd::join_to_restored(const TrackedKeyframe& keyframe) {
  const auto restored = std::span(T_map_keyframes_).first(num_restored_);
  const auto nearest = std::ranges::min_element(restored, {}, [&](const SE3& T_map_base) {
    return distance_m(T_map_base, keyframe.T_map_base);
  });
  if (nearest == restored.end()) {
    return;
  }
  graph_.add_step({.from = static_cast<std::size_t>(nearest - restored.begin()),
                   .to = newest(),
                   .T_from_to = nearest->inverse() * keyframe.T_map_base,
                   .information = rotated(keyframe.information, nearest->linear().transpose())});
}

// Where the map against which the keyframe was registered shows an earlier place, that match was a
// loop closure: the two keyframes are tied together. The present poses agree with it.
void BackEnd::tie_to_map(const TrackedKeyframe& keyframe) {
  const auto nearest = nearest_keyframe(false);
  if (!nearest || keyframe.information.isZero(0.0)) {
    return;
  }
  const SE3& T_map_nearest = T_map_keyframes_[*nearest];
  add_loop({.from = *nearest,
            .to = newest(),
            .T_from_to = T_map_nearest.inverse() * keyframe.T_map_base,
            .information = rotated(keyframe.information, T_map_nearest.linear().transpose())},
           1.0);
}

// The nearest earlier keyframe, in the old map or in the one that is registered against, if it may
// be within the distance of a loop.
std::optional<std::size_t> BackEnd::nearest_keyframe(bool is_old) const {
  std::optional<std::size_t> nearest;
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < newest(); ++k) {
    const double distance_m = geometry::distance_m(T_map_keyframes_[k], T_map_keyframes_.back());
    if (is_in_map_[k] == is_old || path_m_[k] > path_m_.back() - params_.recent_m ||
        distance_m >= nearest_m) {
      continue;
    }
    const auto variance = uncertainty_[k].diagonal();
    const double drift_m = kReachSigmas * std::sqrt(std::max(variance[0], variance[1]));
    if (distance_m <
        params_.match.max_distance_m + std::min(drift_m, params_.search.max_distance_m)) {
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
  const PosePrior prior = prior_from(*nearest);
  const LoopAttempt attempt = match_with_old_map(sweep_base, *nearest, prior);
  const bool is_search = LoopCloser::needs_search(prior);
  metrics_.searches += is_search ? 1 : 0;
  if (!attempt.loop) {
    refuse(*nearest, attempt.refusal);
    return false;
  }
  const std::vector<Loop> believed =
      is_search ? confirm(*attempt.loop) : std::vector{*attempt.loop};
  (is_search ? metrics_.loops_searched : metrics_.loops_tracked) +=
      static_cast<std::int64_t>(believed.size());
  for (const Loop& loop : believed) {
    add_loop(loop);
  }
  return !believed.empty();
}

// The pose of the newest keyframe relative to an old one, with its covariance, by the graph.
PosePrior BackEnd::prior_from(std::size_t old) const {
  const SE3& T_map_base = T_map_keyframes_.back();
  // The same relative pose, inverted.
  const Matrix6d J =
      moment_arm_jacobian(T_map_base.translation() - T_map_keyframes_[old].translation());
  return {.T_map_base = T_map_base,
          .covariance = J * uncertainty_[old] * J.transpose() + 1e-8 * Matrix6d::Identity()};
}

// Searches for a loop from the newest keyframe to the place of keyframe `old`.
LoopAttempt BackEnd::match_with_old_map(const VoxelMap& sweep_base, std::size_t old,
                                        const PosePrior& prior) const {
  VoxelMap sweep = sweep_base;
  sweep.hold();
  LoopAttempt attempt = closer_.match(sweep, old_map_, prior);
  if (attempt.loop) {
    const SE3& T_map_old = T_map_keyframes_[old];
    attempt.loop->from = old;
    attempt.loop->to = newest();
    attempt.loop->T_from_to = T_map_old.inverse() * attempt.loop->T_from_to;
    attempt.loop->information = rotated(attempt.loop->information, T_map_old.linear().transpose());
  }
  return attempt;
}

void BackEnd::refuse(std::size_t old, LoopRefusal reason) {
  refused_.push_back({.from = old, .to = newest(), .reason = reason});
  ++(reason == LoopRefusal::kAmbiguous ? metrics_.refused_ambiguous : metrics_.refused_match);
}

// A loop that was found by a search waits until enough keyframes agree with it; then all of these
// are returned.
std::vector<Loop> BackEnd::confirm(const Loop& loop) {
  refused_.push_back({.from = loop.from, .to = loop.to, .reason = LoopRefusal::kUnconfirmed});
  std::vector<Loop> believed = closer_.add_pending(loop, T_map_keyframes_);
  std::erase_if(refused_, [&believed](const RefusedLoop& refused) {
    return refused.reason == LoopRefusal::kUnconfirmed &&
           std::ranges::any_of(believed, [&refused](const Loop& one) {
             return one.from == refused.from && one.to == refused.to;
           });
  });
  has_searched_loops_ = has_searched_loops_ || !believed.empty();
  return believed;
}

std::vector<bool> BackEnd::certain_keyframes() const {
  std::vector<bool> certain(T_map_keyframes_.size());
  for (std::size_t k = 0; k < certain.size(); ++k) {
    certain[k] =
        path_m_.back() - path_m_[k] < params_.recent_m || is_certain(uncertainty_[k], params_);
  }
  return certain;
}

bool BackEnd::is_outdated(const std::vector<bool>& certain) const {
  std::ptrdiff_t exchanged = 0;
  for (std::size_t k = 0; k < certain.size(); ++k) {
    if (certain[k] != is_in_map_[k]) {
      ++exchanged;
      if (distance_m(T_map_keyframes_[k], T_map_keyframes_.back()) < kWithinReachM) {
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
