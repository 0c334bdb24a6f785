// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/localiser.hpp"

#include <cstdlib>
#include <utility>

#include "common/geometry/angle.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// A sweep from farther apart confirms a place: what it sees differs.
constexpr double kConfirmM = 0.5;
constexpr double kConfirmRad = 0.5;
// A failed search is not repeated from the same place, but things may have moved after a while.
constexpr double kSearchAgainM = 0.1;
constexpr double kSearchAgainRad = 0.2;
constexpr std::int64_t kSearchAgainUs = 5'000'000;

}  // namespace

Localiser::Localiser(const LocaliseParams& params, const RegistrationParams& registration,
                     std::span<const SE3> T_map_keyframes, const VoxelMap& map,
                     const std::optional<SE3>& T_map_start)
    : params_(params), search_(registration, T_map_keyframes, map), T_map_start_(T_map_start) {}

std::optional<SE3> Localiser::find(const VoxelMap& sweep_base, const VoxelMap& map,
                                   const PoseUpdate& by_odometry) {
  if (T_map_start_) {
    state_ = State::kConfirmed;
    return std::exchange(T_map_start_, std::nullopt);
  }
  if (!is_search_due(by_odometry)) {
    return std::nullopt;
  }
  ++metrics_.searches;
  const StartsResult result = search_.find(sweep_base, map);
  if (!result.best || result.best->lowest_inlier_ratio() < params_.min_inlier_ratio) {
    failed_ = Failure{by_odometry.utime_us, by_odometry.T_odom_base};
    return std::nullopt;
  }
  ++metrics_.found;
  failed_.reset();
  state_ = State::kUnconfirmed;
  T_map_found_ = result.best->T_map_base;
  return T_map_found_;
}

bool Localiser::is_search_due(const PoseUpdate& by_odometry) const {
  return !failed_ ||
         is_apart(failed_->T_odom_base, by_odometry.T_odom_base, kSearchAgainM, kSearchAgainRad) ||
         std::abs(by_odometry.utime_us - failed_->utime_us) >= kSearchAgainUs;
}

void Localiser::classify(PoseUpdate& update, int lost_sweeps) {
  Registration& registration = *update.registration;
  // What was searched for must fit as well as when it was found.
  const bool fits = registration.is_accepted() &&
                    (state_ == State::kConfirmed ||
                     registration.lowest_inlier_ratio() >= params_.min_inlier_ratio);
  if (!fits) {
    registration.status = RegistrationStatus::kLost;
    if (state_ == State::kUnconfirmed || lost_sweeps >= params_.max_lost_sweeps) {
      state_ = State::kUnknown;
      ++metrics_.times_lost;
    }
    return;
  }
  if (state_ == State::kUnconfirmed &&
      is_apart(T_map_found_, update.T_map_base, kConfirmM, kConfirmRad)) {
    state_ = State::kConfirmed;
  }
  if (state_ == State::kUnconfirmed) {
    registration.status = RegistrationStatus::kDegraded;
  }
}

}  // namespace nodmap::slam6d
