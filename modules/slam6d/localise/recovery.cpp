// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/localise/recovery.hpp"

#include <cmath>
#include <utility>

namespace nodmap::slam6d {
namespace {

bool is_certain(const Matrix6d& covariance, const LocaliseParams& params) {
  constexpr double kSigmas = 3.0;
  return kSigmas * std::sqrt(covariance.topLeftCorner<3, 3>().trace()) < params.certain_m &&
         kSigmas * std::sqrt(covariance.bottomRightCorner<3, 3>().trace()) < params.certain_rad;
}

// Refuses the match of a sweep: the pose is from odometry alone.
void follow_odometry(Tracker& tracker, const SweepCloud& cloud, PoseUpdate& update) {
  tracker.refuse();
  update = tracker.extrapolate(cloud);
  update.registration = Registration{};
}

}  // namespace

void Recovery::begin_in_saved_map(const Known& saved,
                                  const std::optional<geometry::SE3>& T_map_start, bool is_fixed) {
  localiser_.emplace(params_.localise, params_.registration, saved.keyframes, saved.map,
                     T_map_start);
  localiser_revision_ = saved.graph_revision;
  is_map_fixed_ = is_fixed;
  is_map_closed_ = true;
}

void Recovery::change_odometry_frame(const std::optional<geometry::SE3>& T_old_new) {
  if (T_old_new && by_odometry_) {
    by_odometry_->change_odometry_frame(*T_old_new);
  }
  if (localiser_) {
    localiser_->change_odometry_frame();
  }
}

void Recovery::find_place(const Known& known, const VoxelMap& sweep, const SweepCloud& cloud,
                          PoseUpdate& update) {
  auto T_map_base = localiser_->find({sweep, cloud}, known.map, update);
  if (!T_map_base) {
    known.tracker.forget_pose();
    update.registration = Registration{};
    return;
  }
  if (localiser_->is_told()) {
    // The start pose is that at the first beam of all; odometry knows the way from there.
    *T_map_base = *T_map_base * T_first_start_->inverse() * update.T_first_odom * cloud.T_odom_base;
  }
  known.tracker.begin_at(*T_map_base, cloud);
  update = known.tracker.extrapolate(cloud);
}

bool Recovery::check_place(const Known& known, int lost_before, VoxelMap& sweep, SweepCloud& cloud,
                           PoseUpdate& update) {
  bool is_found = false;
  if (!is_map_closed_ && lost_before > 0) {
    if (lost_before == 1 && localiser_) {
      localiser_->forget_place();
    }
    is_found = recover(known, sweep, cloud, update);
  }
  if (is_map_closed_) {
    classify_place(known, sweep, cloud, update);
    if (by_odometry_ && !localiser_->has_place()) {
      take_back_place(known, cloud, update);
    }
  }
  return is_found;
}

void Recovery::classify_place(const Known& known, const VoxelMap& sweep, const SweepCloud& cloud,
                              PoseUpdate& update) {
  const bool was_accepted = update.is_tracked();
  localiser_->classify({sweep, cloud}, known.map, update, known.tracker.lost_sweeps());
  if (update.registration->is_accepted() != was_accepted) {
    follow_odometry(known.tracker, cloud, update);
  }
  // Whatever its state: along a bare corridor poses stay DEGRADED, as for a robot never lost.
  if (localiser_->is_confirmed()) {
    by_odometry_.reset();
    is_map_closed_ = is_map_fixed_ || !update.is_tracked();
  }
}

// For a robot that was lost while it maps, because it was kicked or carried away. Odometry says
// little about its place, and walls fit walls in many places, so a place that contradicts the space
// that was seen is refused. This is not checked if odometry excludes all other places, because
// people nearby contradict that space, too.
bool Recovery::recover(const Known& known, VoxelMap& sweep, SweepCloud& cloud, PoseUpdate& update) {
  Tracker& tracker = known.tracker;
  if (update.is_tracked() && !is_certain(tracker.extrapolate(cloud).covariance, params_.localise) &&
      localiser_in_own_map(known).is_contradicted_at(sweep, update.T_map_base)) {
    follow_odometry(tracker, cloud, update);
  }
  return tracker.lost_sweeps() >= params_.localise.max_lost_sweeps &&
         search_own_map(known, sweep, cloud, update);
}

// Made only when it is needed, and again only if keyframes have changed: to trace the beams of all
// keyframes takes some 2 ms for each, and poses wait for it.
Localiser& Recovery::localiser_in_own_map(const Known& known) {
  if (!localiser_ || localiser_revision_ != known.graph_revision) {
    const auto metrics = localiser_ ? localiser_->metrics() : Localiser::Metrics{};
    localiser_.emplace(params_.localise, params_.registration, known.keyframes, known.map,
                       std::nullopt);
    localiser_->count_from(metrics);
    localiser_revision_ = known.graph_revision;
  }
  return *localiser_;
}

// Searches as in a saved map.
bool Recovery::search_own_map(const Known& known, VoxelMap& sweep, SweepCloud& cloud,
                              PoseUpdate& update) {
  Tracker& tracker = known.tracker;
  VoxelMap as_measured = voxelize(cloud, params_.voxels);
  const auto T_map_base = localiser_in_own_map(known).find({as_measured, cloud}, known.map, update);
  if (!T_map_base) {
    return false;
  }
  by_odometry_ = tracker;
  first_at_place_ = known.corrected.num_added();
  is_map_closed_ = true;
  tracker.begin_at(*T_map_base, cloud);
  update = tracker.extrapolate(cloud);
  sweep = std::move(as_measured);
  tracker.track(sweep, known.map, cloud, update);
  return true;
}

// The place that was found is wrong: odometry continues from where the robot was lost, and so does
// the search. The sweeps that were registered there (DEGRADED, because the place was not confirmed)
// follow odometry, too.
void Recovery::take_back_place(const Known& known, const SweepCloud& cloud, PoseUpdate& update) {
  Tracker& tracker = known.tracker;
  tracker = *std::exchange(by_odometry_, std::nullopt);
  tracker.interrupt();
  is_map_closed_ = false;
  const std::size_t num_tracked = known.corrected.take_back(first_at_place_);
  known.counts.sweeps_degraded -= num_tracked;
  known.counts.sweeps_lost += num_tracked;
  known.corrected.place(first_at_place_, [&tracker](const geometry::SE3& T_first_base) {
    return tracker.extrapolate(T_first_base);
  });
  update = tracker.extrapolate(cloud);
  update.registration = Registration{};
}

}  // namespace nodmap::slam6d
