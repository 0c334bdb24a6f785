// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/localise/localiser.hpp"

#include <cstdlib>
#include <utility>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/geometry/pose_tolerance.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// A place is doubted on the evidence of about the last ten sweeps together, because a person who
// walks by contradicts the map, too.
constexpr double kMemory = 0.9;

std::vector<SE3> poses_of(std::span<const Keyframe> keyframes) {
  std::vector<SE3> poses;
  for (const Keyframe& keyframe : keyframes) {
    poses.push_back(keyframe.T_map_base);
  }
  return poses;
}

}  // namespace

Localiser::Localiser(const LocaliseParams& params, const RegistrationParams& registration,
                     std::span<const Keyframe> keyframes, const VoxelMap& map,
                     const std::optional<SE3>& T_map_start)
    : params_(params),
      seen_(params.seen, keyframes),
      search_(params.place, registration, poses_of(keyframes), map),
      T_map_start_(T_map_start),
      seen_here_(params.seen) {}

std::optional<SE3> Localiser::find(const Sweep& sweep, const VoxelMap& map,
                                   const PoseUpdate& by_odometry) {
  if (T_map_start_) {
    begin_place(*T_map_start_);
    is_told_ = true;
    return std::exchange(T_map_start_, std::nullopt);
  }
  if (!is_search_due(by_odometry)) {
    return std::nullopt;
  }
  ++metrics_.searches;
  const StartsResult result = search_.find(sweep.voxels, map, [&](const SE3& T_map_base) {
    return is_possible(sweep, map, T_map_base);
  });
  if (!result.best || result.best->lowest_inlier_ratio() < params_.place.min_inlier_ratio) {
    failed_ = Failure{by_odometry.stamp, by_odometry.T_odom_base};
    return std::nullopt;
  }
  ++metrics_.found;
  begin_place(result.best->T_map_base);
  return T_map_found_;
}

void Localiser::begin_place(const SE3& T_map_base) {
  forget_place();
  state_ = State::kUnconfirmed;
  T_map_found_ = T_map_base;
}

// A place in another corridor that looks alike is contradicted both ways: things stand where the
// map is free, and the map's things are missing.
bool Localiser::is_possible(const Sweep& sweep, const VoxelMap& map, const SE3& T_map_base) const {
  if (is_contradicted_at(sweep.voxels, T_map_base)) {
    return false;
  }
  SeenSpace seen_here(params_.seen);
  seen_here.add(sweep.cloud, T_map_base);
  return !is_too_much_missing(seen_here.compare_map(map, seen_, T_map_base.translation()));
}

bool Localiser::is_search_due(const PoseUpdate& by_odometry) const {
  return !failed_ ||
         !geometry::is_within(failed_->T_odom_base, by_odometry.T_odom_base,
                              {params_.search_again_m, params_.search_again_rad}) ||
         std::chrono::abs(by_odometry.stamp - failed_->stamp) >=
             time::from_seconds(params_.search_again_s);
}

void Localiser::classify(const Sweep& sweep, const VoxelMap& map, PoseUpdate& update,
                         int lost_sweeps) {
  Registration& registration = *update.registration;
  const bool is_known = registration.lowest_inlier_ratio() >= params_.place.min_inlier_ratio;
  // A place found by a search must go on fitting as well as when it was found.
  const bool fits = registration.is_accepted() && (!is_doubtful() || is_known);
  if (!fits) {
    registration.state = PoseState::kLost;
    if (is_doubtful() || lost_sweeps >= params_.max_lost_sweeps) {
      give_up();
    }
    return;
  }
  add_evidence(sweep, map, update);
  if (is_contradicted()) {
    registration.state = PoseState::kLost;
    ++metrics_.times_contradicted;
    give_up();
    return;
  }
  if (is_known && confirms(update.T_map_base)) {
    state_ = State::kConfirmed;
  }
  if (!is_told_ && (state_ == State::kUnconfirmed || !is_known)) {
    registration.state = PoseState::kDegraded;
  }
}

bool Localiser::confirms(const SE3& T_map_base) const {
  return geometry::distance_m(T_map_base, T_map_found_) > params_.confirm_distance_m &&
         evidence_.contradiction_ratio() <= params_.place.max_contradiction_ratio &&
         !is_too_much_missing(missing_);
}

// What one sweep misses, such as the legs of a table, the next may show: all sweeps since the place
// was found are taken together.
void Localiser::add_evidence(const Sweep& sweep, const VoxelMap& map, const PoseUpdate& update) {
  const Evidence evidence = seen_.compare(sweep.voxels, update.T_map_base);
  evidence_.seen = kMemory * evidence_.seen + evidence.seen;
  evidence_.contradicted = kMemory * evidence_.contradicted + evidence.contradicted;
  if (state_ == State::kUnconfirmed) {
    SweepCloud cloud = sweep.cloud;
    cloud.correct(update.registration->correction);
    seen_here_.add(cloud, update.T_map_base);
    missing_ = seen_here_.compare_map(map, seen_, update.T_map_base.translation());
  }
}

bool Localiser::is_contradicted() const {
  const double tolerance = is_doubtful() ? 1.0 : params_.confirmed_tolerance;
  return evidence_.contradiction_ratio() > tolerance * params_.place.max_contradiction_ratio ||
         (is_doubtful() && is_too_much_missing(missing_));
}

void Localiser::give_up() {
  forget_place();
  ++metrics_.times_lost;
}

void Localiser::forget_place() {
  state_ = State::kUnknown;
  is_told_ = false;
  evidence_ = {};
  seen_here_ = SeenSpace(params_.seen);
  missing_ = {};
  failed_.reset();
}

}  // namespace nodmap::slam6d
