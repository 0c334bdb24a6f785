// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/front_end/doubt.hpp"

#include <algorithm>

namespace nodmap::slam2d {
namespace {

// Greatest speed of a robot without odometry.
constexpr double kMaxSpeedMps = 3.0;
constexpr double kMaxReachM = 1000.0;  // beyond any map
constexpr double kReachSigmas = 3.0;

}  // namespace

// The search limits only what is added: a wider doubt from lost messages stays.
void Doubt::begin(double odometry_gap_s) {
  const double reach_m =
      std::min(reach_m_ + kMaxSpeedMps * odometry_gap_s, params_.search_distance_m);
  reach_m_ = std::max(reach_m_, reach_m);
}

void Doubt::begin_by_odometry(double sigma_m) {
  reach_m_ = std::max(reach_m_, std::min(kReachSigmas * sigma_m, kMaxReachM));
}

double Doubt::sigma_m() const {
  return reach_m_ / kReachSigmas;
}

double Doubt::search_distance_m() const {
  return std::min(reach_m_, params_.search_distance_m);
}

bool Doubt::update(const PoseUpdate& update, bool is_sure) {
  const bool was_active = is_active();
  if (update.state == PoseState::kLost) {
    reach_m_ = std::max(reach_m_, params_.search_distance_m);
  } else if (update.is_matched() && is_sure) {
    reach_m_ = 0.0;
  }
  since_ = is_active() ? std::optional(since_.value_or(update.stamp)) : std::nullopt;
  return was_active && !is_active();
}

void Doubt::end() {
  reach_m_ = 0.0;
  since_.reset();
}

}  // namespace nodmap::slam2d
