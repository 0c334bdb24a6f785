// SPDX-License-Identifier: BSD-3-Clause
// The part of Slam6d that finds the robot while its place is unknown: in a saved map, or in its own
// map after LOST.
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "modules/slam6d/slam6d.hpp"
#include "modules/slam6d/sweep_voxels.hpp"

namespace nodmap::slam6d {
namespace {

bool is_certain(const Matrix6d& covariance, const LocaliseParams& params) {
  constexpr double kSigmas = 3.0;
  return kSigmas * std::sqrt(covariance.topLeftCorner<3, 3>().trace()) < params.certain_m &&
         kSigmas * std::sqrt(covariance.bottomRightCorner<3, 3>().trace()) < params.certain_rad;
}

}  // namespace

// For a robot in a saved map: until it is found there, it has no pose.
void Slam6d::find_place(const VoxelMap& sweep, const SweepCloud& cloud, PoseUpdate& update) {
  if (auto T_map_base = localiser_->find(sweep, map_, update)) {
    if (localiser_->is_confirmed()) {
      // A given start pose, which needs no confirmation, is the pose at the sweep's first beam.
      *T_map_base = *T_map_base * cloud.T_base_first.inverse();
    }
    tracker_.begin_at(*T_map_base, cloud);
    update = tracker_.extrapolate(cloud);
    return;
  }
  tracker_.forget_pose();
  update.registration = Registration{};
  counts_.count(update.registration->state);
}

// A wrong place would spoil the map, so new keyframes enter it only once the place is confirmed.
void Slam6d::classify_place(const VoxelMap& sweep, PoseUpdate& update) {
  localiser_->classify(sweep, update, tracker_.lost_sweeps());
  is_map_closed_ = is_map_fixed_ || !localiser_->is_confirmed() ||
                   update.registration->state != PoseState::kTracking;
  if (!is_map_closed_) {
    by_odometry_.reset();
  }
}

// For a robot that was lost while it maps, because it was kicked or carried away. Odometry says
// little about its place, and walls fit walls in many places, so a place that contradicts the space
// that was seen is refused. This is not checked if odometry excludes all other places, because
// people nearby contradict that space, too.
void Slam6d::recover(VoxelMap& sweep, const SweepCloud& cloud, PoseUpdate& update) {
  if (update.is_tracked() &&
      !is_certain(tracker_.extrapolate(cloud).covariance, params_.localise) &&
      localiser_in_own_map().is_contradicted_at(sweep, update.T_map_base)) {
    tracker_.refuse();
    update = tracker_.extrapolate(cloud);
    update.registration = Registration{};
  }
  if (tracker_.lost_sweeps() >= params_.localise.max_lost_sweeps) {
    search_own_map(sweep, cloud, update);
  }
}

// Made only when it is needed, and again only if keyframes have changed: to trace the beams of all
// keyframes takes some 2 ms for each, and poses wait for it.
Localiser& Slam6d::localiser_in_own_map() {
  const std::int64_t revision = back_end_.graph_revision();
  if (!localiser_ || localiser_revision_ != revision) {
    const auto metrics = localiser_ ? localiser_->metrics() : Localiser::Metrics{};
    localiser_.emplace(params_.localise, params_.registration, keyframes_, map_, std::nullopt);
    localiser_->count_from(metrics);
    localiser_revision_ = revision;
  }
  return *localiser_;
}

// Searches as in a saved map. Nothing enters its own map until the place is confirmed.
void Slam6d::search_own_map(VoxelMap& sweep, const SweepCloud& cloud, PoseUpdate& update) {
  VoxelMap as_measured = voxelize(cloud, params_.voxels);
  const auto T_map_base = localiser_in_own_map().find(as_measured, map_, update);
  if (!T_map_base) {
    return;
  }
  by_odometry_ = tracker_;
  first_at_place_ = corrected_.num_added();
  is_map_closed_ = keyframe_is_due_ = true;
  tracker_.begin_at(*T_map_base, cloud);
  update = tracker_.extrapolate(cloud);
  sweep = std::move(as_measured);
  tracker_.track(sweep, map_, cloud, update);
}

// The place that was found is wrong: odometry continues from where the robot was lost, and so does
// the search. The sweeps that were registered there (DEGRADED, because the place was not confirmed)
// follow odometry, too.
void Slam6d::take_back_place(const SweepCloud& cloud, PoseUpdate& update) {
  tracker_ = *std::exchange(by_odometry_, std::nullopt);
  tracker_.interrupt();
  is_map_closed_ = false;
  const std::size_t num_tracked = corrected_.take_back(first_at_place_);
  counts_.sweeps_degraded -= num_tracked;
  counts_.sweeps_lost += num_tracked;
  corrected_.place(first_at_place_, [this](const geometry::SE3& T_first_base) {
    return tracker_.extrapolate(T_first_base);
  });
  update = tracker_.extrapolate(cloud);
  update.registration = Registration{};
}

}  // namespace nodmap::slam6d
