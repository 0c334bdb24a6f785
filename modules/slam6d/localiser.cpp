// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/localiser.hpp"

#include <cstdlib>
#include <utility>
#include <vector>

#include "common/geometry/angle.hpp"
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
      T_map_start_(T_map_start) {}

std::optional<SE3> Localiser::find(const VoxelMap& sweep_base, const VoxelMap& map,
                                   const PoseUpdate& by_odometry) {
  if (T_map_start_) {
    state_ = State::kUnconfirmed;
    is_told_ = true;
    T_map_found_ = *T_map_start_;
    return std::exchange(T_map_start_, std::nullopt);
  }
  if (!is_search_due(by_odometry)) {
    return std::nullopt;
  }
  ++metrics_.searches;
  const StartsResult result = search_.find(sweep_base, map, seen_);
  if (!result.best || result.best->lowest_inlier_ratio() < params_.place.min_inlier_ratio) {
    failed_ = Failure{by_odometry.stamp, by_odometry.T_odom_base};
    return std::nullopt;
  }
  ++metrics_.found;
  failed_.reset();
  state_ = State::kUnconfirmed;
  T_map_found_ = result.best->T_map_base;
  evidence_ = {};
  return T_map_found_;
}

bool Localiser::is_search_due(const PoseUpdate& by_odometry) const {
  return !failed_ ||
         is_apart(failed_->T_odom_base, by_odometry.T_odom_base, params_.search_again_m,
                  params_.search_again_rad) ||
         std::chrono::abs(by_odometry.stamp - failed_->stamp) >=
             time::from_seconds(params_.search_again_s);
}

void Localiser::classify(const VoxelMap& sweep_base, PoseUpdate& update, int lost_sweeps) {
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
  add_evidence(seen_.compare(sweep_base, update.T_map_base));
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
  return (T_map_base.translation() - T_map_found_.translation()).norm() >
             params_.confirm_distance_m &&
         evidence_.contradiction_ratio() <= params_.place.max_contradiction_ratio;
}

void Localiser::add_evidence(const Evidence& evidence) {
  evidence_.seen = kMemory * evidence_.seen + evidence.seen;
  evidence_.contradicted = kMemory * evidence_.contradicted + evidence.contradicted;
}

bool Localiser::is_contradicted() const {
  const double tolerance = is_doubtful() ? 1.0 : params_.confirmed_tolerance;
  return evidence_.contradiction_ratio() > tolerance * params_.place.max_contradiction_ratio;
}

void Localiser::give_up() {
  forget_place();
  ++metrics_.times_lost;
}

void Localiser::forget_place() {
  state_ = State::kUnknown;
  is_told_ = false;
  evidence_ = {};
  failed_.reset();
}

}  // namespace nodmap::slam6d
