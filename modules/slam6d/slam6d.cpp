// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/slam6d.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "modules/slam6d/back_end/adjusted_sweeps.hpp"
#include "modules/slam6d/tracking/odometry_prior.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// A saved keyframe votes for the sweeps up to the next one as well, which were not saved.
constexpr int kVotesOfSavedKeyframe = 2;

}  // namespace

Slam6d::Slam6d(const Slam6dParams& params)
    : params_(params),
      collector_(params.sweep, params.assume_stationary),
      tracker_(params),
      mount_(params.mount),
      map_(params.voxels),
      ever_free_(params.cloud),
      corrected_(params.path),
      back_end_(params.loop, params.registration, params.odometry, params.voxels),
      recovery_(params) {}

std::vector<PoseUpdate> Slam6d::change_odometry_frame(const SE3& T_new_odom_base) {
  std::vector<PoseUpdate> updates;
  while (const auto update = flush()) {
    updates.push_back(*update);
  }
  const auto T_old_new = collector_.change_odometry_frame(T_new_odom_base);
  first_sweeps_.drop();  // the motion to them is unknown
  if (T_old_new) {
    tracker_.change_odometry_frame(*T_old_new);
    keyframe_is_due_ = true;
  }
  recovery_.change_odometry_frame(T_old_new);
  return updates;
}

void Slam6d::restore(const SavedMap& saved, const std::optional<SE3>& T_map_start, bool is_fixed) {
  for (const SavedMap::Keyframe& keyframe : saved.keyframes) {
    const VoxelMap sweep = voxelize(*keyframe.cloud, params_.voxels);
    map_.add_sweep(sweep, keyframe.T_map_base, keyframes_.size());
    ever_free_.add_sweep(*keyframe.cloud, keyframe.T_map_base, keyframes_.size(),
                         kVotesOfSavedKeyframe);
    keyframes_.push_back(
        {.id = keyframes_.size(), .T_map_base = keyframe.T_map_base, .cloud = keyframe.cloud});
    keyframes_.back().keep_voxels(sweep);
  }
  find_moved_points();
  back_end_.restore(saved);
  recovery_.begin_in_saved_map(known(), T_map_start, is_fixed);
  num_restored_ = keyframes_.size();
  first_sweeps_.drop();
  keyframe_is_due_ = true;
}

// The text of section IV B, where it describes what is done here.
std::optional<PoseUpdate> Slam6d::add_scan(scan::Scan scan) {
  // "... segment the continuous data flow to reflect one complete pitch movement per point cloud."
  const auto sweep = collect(std::move(scan));
  return sweep ? std::optional(add_sweep(*sweep)) : std::nullopt;
}

std::optional<PoseUpdate> Slam6d::flush() {
  const auto sweep = collect_rest();
  return sweep ? std::optional(add_sweep(*sweep)) : std::nullopt;
}

PoseUpdate Slam6d::add_sweep(const PlacedSweep& sweep) {
  mount_.learn(sweep);
  first_sweeps_.add(sweep);
  if (mount_.is_corrected_anew(tracker_.mount()) && tracker_.lost_sweeps() == 0) {
    if (first_sweeps_.are_kept() && !recovery_.is_map_closed()) {
      return repeat_first_sweeps();
    }
    // A saved map is right, because it has begun again in its time.
    if (num_restored_ > 0 && recovery_.has_place()) {
      tracker_.correct_mount(mount_.error());
    }
  }
  return register_sweep(sweep);
}

// All sweeps so far were deskewed as if the laser were mounted otherwise, and have tilted the map,
// so that later ones, deskewed rightly, would not fit it.
PoseUpdate Slam6d::repeat_first_sweeps() {
  const CorrectedPoses published = std::exchange(corrected_, CorrectedPoses(params_.path));
  counts_ = {};
  tracker_ = Tracker(params_, mount_.error());
  recovery_ = Recovery(params_);
  forget_map();
  PoseUpdate update;
  for (const PlacedSweep& sweep : first_sweeps_.sweeps()) {
    update = register_sweep(sweep);
  }
  corrected_.keep_online(published);
  counts_.count_tracked_before(first_sweeps_.num_emptied());
  update.begins_anew = true;
  return update;
}

PoseUpdate Slam6d::register_sweep(const PlacedSweep& sweep) {
  if (corrected_.num_added() == 1 && first_sweeps_.are_kept()) {
    learn_pitch_latency_at_start(sweep);
  }
  // "The robot's movement in space [...] during the pitching movement, is stripped from the point
  // cloud by transforming the successively gathered 2D scans": to the base pose P_b.
  return add_cloud(tracker_.deskew(sweep));
}

PoseUpdate Slam6d::add_cloud(SweepCloud cloud) {
  PoseUpdate update = follow_odometry(cloud);
  auto sweep = voxels_to_register(cloud, update);
  if (!sweep) {
    tracker_.pass(cloud);
    record(update);
    return update;
  }
  if (is_better_beginning(*sweep)) {
    begin_anew();
    update = tracker_.extrapolate(cloud);
  }
  // "The generated point clouds are registered into an incrementally built 3D model": the transform
  // that fits them to it corrects the pose by odometry.
  track(*sweep, cloud, update);
  // "... only those whose robot base poses P_b are further than 2 m away from each other or that
  // correspond to a rotation of more than 45 deg": here these become keyframes; all are registered.
  update.keyframe = keyframe_reason(update);
  if (update.is_tracked()) {
    tracker_.accept(cloud, update);
    add_to_map(*sweep, cloud, update);
  } else {
    tracker_.pass(cloud);
  }
  record(update);
  if (update.keyframe) {
    add_keyframe(*sweep, std::move(cloud), update);
    // Beyond the paper: a place that is recognised corrects the whole path since.
    close_loops(*sweep, update);
    drop_replaced_keyframes();
  }
  return update;
}

PoseUpdate Slam6d::follow_odometry(const SweepCloud& cloud) {
  if (cloud.follows_interruption) {
    tracker_.interrupt();
    keyframe_is_due_ = true;
  }
  PoseUpdate update = tracker_.extrapolate(cloud);
  update.is_place_known = recovery_.has_place();
  if (cloud.scans_used > 0) {
    recovery_.note_start(update.T_first_odom * cloud.T_odom_base * cloud.T_base_first);
  }
  return update;
}

// None of a sweep that is cut short, and none of one with so few planes that it says nothing for or
// against odometry: somebody stands in front of the laser.
std::optional<VoxelMap> Slam6d::voxels_to_register(const SweepCloud& cloud,
                                                   const PoseUpdate& update) const {
  // So far from the origin of odometry that the map has no voxels there.
  const double farthest_m =
      update.T_map_base.translation().cwiseAbs().maxCoeff() + params_.range.max_m;
  if (!is_usable(update) || farthest_m > map_.level(0).reach_m()) {
    return std::nullopt;
  }
  VoxelMap sweep = voxelize(cloud, params_.voxels);
  return sweep.select(0).points.size() < static_cast<std::size_t>(params_.registration.min_planes)
             ? std::nullopt
             : std::optional(std::move(sweep));
}

// The first sweep has no pose to be tracked from: it is the map.
void Slam6d::track(VoxelMap& sweep, SweepCloud& cloud, PoseUpdate& update) {
  if (!update.is_place_known) {
    recovery_.find_place(known(), sweep, cloud, update);
  }
  if (!tracker_.has_pose()) {
    return;
  }
  const int lost_before = tracker_.lost_sweeps();
  tracker_.track(sweep, map_, cloud, update);
  if (recovery_.check_place(known(), lost_before, sweep, cloud, update)) {
    keyframe_is_due_ = true;
  }
  if (!recovery_.is_map_closed()) {
    const SE3 motion = keyframes_.back().T_map_base.inverse() * update.T_map_base;
    update.distance_m = motion.translation().norm();
    update.rotation_rad = geometry::rotation_angle(motion);
  }
}

void Slam6d::record(const PoseUpdate& update) {
  if (update.registration) {
    counts_.count(update.registration->state);
  } else if (update.keyframe != KeyframeReason::kFirst) {
    ++counts_.sweeps_unused;
  }
  if (corrected_.is_full()) {
    dropped_.make_room(corrected_, keyframes_, between_);
  }
  corrected_.add(update);
}

void Slam6d::add_keyframe(const VoxelMap& sweep, SweepCloud cloud, const PoseUpdate& update) {
  cloud.drop_free_points();
  keyframes_.push_back({.id = keyframes_.empty() ? 0 : keyframes_.back().id + 1,
                        .sweep = corrected_.num_added() - 1,
                        .T_map_base = update.T_map_base,
                        .cloud = std::make_shared<const SweepCloud>(std::move(cloud)),
                        .update = update});
  Keyframe& keyframe = keyframes_.back();
  keyframe.keep_voxels(sweep);
  keyframe.is_moved = ever_free_.moved_points(*keyframe.cloud, keyframes_.size() - 1);
  keyframe_is_due_ = false;
}

// The first sweep may be cut short, as the head may move already. No whole sweep would fit it.
bool Slam6d::is_better_beginning(const VoxelMap& sweep) const {
  constexpr std::size_t kCutShort = 2;
  return num_restored_ == 0 && tracker_.has_pose() &&
         counts_.sweeps_tracked + counts_.sweeps_degraded == 0 &&
         sweep.level(0).voxels().size() >= kCutShort * map_.level(0).voxels().size();
}

void Slam6d::begin_anew() {
  corrected_.take_back(keyframes_.front().sweep);
  forget_map();
  tracker_.forget_pose();
  counts_.sweeps_lost = 0;
}

void Slam6d::forget_map() {
  map_ = VoxelMap(params_.voxels);
  ever_free_ = EverFreeSpace(params_.cloud);
  keyframes_.clear();
  between_.clear();
  dropped_.clear();
  const std::int64_t graph_revision = back_end_.graph_revision();
  back_end_ = BackEnd(params_.loop, params_.registration, params_.odometry, params_.voxels);
  back_end_.count_revisions_from(graph_revision);
}

// If the robot is stationary at first, its second sweep gives the latency at once. Then the map
// begins again with the first sweep, which would otherwise tilt everything that follows.
void Slam6d::learn_pitch_latency_at_start(const PlacedSweep& sweep) {
  const SweepCloud cloud = tracker_.deskew(sweep);
  const PoseUpdate update = tracker_.extrapolate(cloud);
  if (!tracker_.has_pose() || num_restored_ > 0 || keyframes_.size() != 1 || !is_usable(update) ||
      !update.is_stationary || !keyframes_.front().cloud->is_stationary() ||
      sweep.follows_interruption || !is_planar(cloud.T_odom_base)) {
    return;
  }
  Keyframe& first = keyframes_.front();
  VoxelMap voxels = voxelize(cloud, params_.voxels);
  if (!tracker_.learn_pitch_latency_at_start(voxels, map_, cloud, update,
                                             first.cloud->pitch_rate_rad_s)) {
    return;
  }
  first.cloud = std::make_shared<const SweepCloud>(tracker_.deskew(first_sweeps_.sweeps().front()));
  const VoxelMap first_voxels = voxelize(*first.cloud, params_.voxels);
  first.keep_voxels(first_voxels);
  map_ = VoxelMap(params_.voxels);
  map_.add_sweep(first_voxels, first.T_map_base);
  ever_free_ = EverFreeSpace(params_.cloud);
  ever_free_.add_sweep(*first.cloud, first.T_map_base, 0);
}

// Only what was registered enters the map: a refused sweep leaves no trace, nor does slip.
void Slam6d::add_to_map(const VoxelMap& sweep, const SweepCloud& cloud, const PoseUpdate& update) {
  if (recovery_.is_map_closed() || update.is_slipped()) {
    return;
  }
  const std::size_t keyframe = keyframes_.size() - (update.keyframe ? 0 : 1);
  map_.add_sweep(sweep, update.T_map_base, keyframe);
  ever_free_.add_sweep(cloud, update.T_map_base, keyframe);
  if (!update.keyframe && is_adjusted(update)) {
    between_.push_back(
        {corrected_.num_added(), adjusted_points(cloud.points, params_.adjustment), update});
  }
}

// Whether a sweep between keyframes is far enough from the last one that is adjusted.
bool Slam6d::is_adjusted(const PoseUpdate& update) const {
  if (!params_.adjustment.use || num_restored_ > 0) {
    return false;
  }
  const std::size_t last =
      std::max(keyframes_.back().sweep, between_.empty() ? 0 : between_.back().sweep);
  return geometry::distance_m(update.T_map_base, corrected_.pose_of(last)) >
         params_.adjustment.sweep_distance_m;
}

std::optional<KeyframeReason> Slam6d::keyframe_reason(const PoseUpdate& update) const {
  if (recovery_.is_map_closed() || update.is_slipped() ||
      !(keyframes_.empty() || update.is_tracked())) {
    return std::nullopt;
  }
  if (keyframes_.empty()) {
    return KeyframeReason::kFirst;
  }
  return keyframe_is_due_ ? KeyframeReason::kInterruption
                          : params_.keyframe.reason(update.distance_m, update.rotation_rad);
}

Metrics Slam6d::metrics() const {
  Metrics metrics = counts_;
  metrics.map_voxels = map_.level(0).voxels().size();
  metrics.map_memory_bytes = map_.memory_bytes();
  metrics.keyframe_memory_bytes = memory_bytes(keyframes_) + memory_bytes(between_);
  return metrics;
}

void Slam6d::close_loops(const VoxelMap& sweep, PoseUpdate& update) {
  const Keyframe& keyframe = keyframes_.back();
  TrackedKeyframe tracked{.T_map_base = keyframe.T_map_base,
                          .follows_interruption = update.keyframe == KeyframeReason::kInterruption,
                          .odometry_scatter = tracker_.odometry_scatter(),
                          .is_level = is_planar(keyframe.cloud->T_odom_base) &&
                                      is_level(keyframe.T_map_base, params_.odometry)};
  if (update.registration) {
    tracked.information = registration::inverse(update.covariance);
  }
  if (const auto T_map_keyframes = back_end_.add_keyframe(tracked, sweep, map_)) {
    move_keyframes(*T_map_keyframes);
    update.T_map_base = keyframe.T_map_base;
    update.T_map_odom = tracker_.T_map_odom();
    corrected_.set_online(update.T_map_base);
  }
}

// The mapped volume bounds the memory, not the length of the path: where the robot drives again and
// again, newer keyframes show all that old ones showed.
void Slam6d::drop_replaced_keyframes() {
  const int num_newer = params_.keyframe.max_per_place;
  if (num_newer == 0) {
    return;
  }
  while (const auto replaced = back_end_.replaced_keyframe(num_newer)) {
    const bool is_restored = replaced->index < num_restored_;
    dropped_.drop(*replaced, is_restored, corrected_, keyframes_, between_);
    num_restored_ -= is_restored ? 1 : 0;
    ever_free_.drop_keyframe(*replaced);
    back_end_.drop_keyframe(*replaced, map_);
  }
}

void Slam6d::polish() {
  if (back_end_.has_loops()) {
    move_keyframes(back_end_.polish());
  }
  // Nothing is adjusted if odometry does not know the way from a saved keyframe to a new one.
  if (params_.adjustment.use && num_restored_ == 0 && !keyframes_.empty()) {
    adjust();
  }
  find_moved_points();
}

void Slam6d::adjust() {
  const AdjustedPoses adjusted = adjusted_poses(
      {keyframes_, between_, corrected_, back_end_.graph().steps()}, tracker_, params_);
  move_keyframes(adjusted.T_map_keyframes);
  back_end_.take_adjusted(adjusted.T_map_keyframes);
  corrected_.move(adjusted.sweeps);
}

void Slam6d::find_moved_points() {
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    keyframes_[k].is_moved = ever_free_.moved_points(*keyframes_[k].cloud, k);
  }
}

void Slam6d::move_keyframes(std::span<const SE3> T_map_keyframes) {
  const SE3 T_new_old = normalized(T_map_keyframes.back() * keyframes_.back().T_map_base.inverse());
  std::vector<CorrectedPoses::Correction> corrections =
      dropped_.corrections(keyframes_, T_map_keyframes, corrected_);
  for (std::size_t k = 0; k < keyframes_.size(); ++k) {
    keyframes_[k].T_map_base = T_map_keyframes[k];
    if (k >= num_restored_) {
      corrections.push_back({keyframes_[k].sweep, T_map_keyframes[k]});
    }
  }
  std::ranges::sort(corrections, {}, &CorrectedPoses::Correction::sweep);
  corrected_.move(corrections);
  ever_free_.move_keyframes(T_map_keyframes);
  tracker_.move(T_new_old);
}

}  // namespace nodmap::slam6d
