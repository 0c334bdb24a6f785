// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/behaviours/back_up.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::navigator {
namespace {

// A shorter rotation back to the heading of the trail does not help.
constexpr double kMinRotationRad = geometry::deg_to_rad(2.0);
// Margin beside and behind the body over its own trail.
constexpr double kMarginM = 0.02;
// With less than this beyond the margin the robot would not move.
constexpr double kMinDistanceM = 0.01;
// If the robot cannot rotate to the heading of its trail at all, as between people's feet, it
// backs up straight, unless its heading is off by more than this. Over the 8 cm to the next pose
// of the trail this leads 6 cm aside: as much as the clearance that it kept there.
constexpr double kObliqueRad = geometry::deg_to_rad(45.0);

}  // namespace

BackUp::BackUp(const NavigatorParams& params)
    : body_(params.robot.body.footprint()),
      turn_margin_m_(params.turn.margin_m),
      params_(params.back_up),
      trail_(params.local_map.forget_after_m) {}

void BackUp::record(const geometry::SE2& T_odom_base, double forward_mps) {
  trail_.move(T_odom_base);
  if (forward_mps < -kReversingMps) {
    trail_.forget_ahead(T_odom_base);
  } else if (!began_at_) {
    trail_.record(T_odom_base);
  }
}

std::optional<Twist> BackUp::step(const Situation& now, const Brake& brake) {
  if (!began_at_) {
    began_at_ = now.T_odom_base;
  }
  const auto path = trail_.path_back(now.T_odom_base);
  const Side side = path ? side_of(path->rotation_rad) : Side::kLeft;
  const double free_rad = free_rotation(now.points_base, side, body_, turn_margin_m_);
  const bool can_rotate = free_rad >= kMinRotationRad;
  const double backed_up_m = geometry::distance_m(*began_at_, now.T_odom_base);
  if (!path || (!can_rotate && std::abs(path->rotation_rad) > kObliqueRad) ||
      backed_up_m >= params_.distance_m) {
    end();
    return std::nullopt;
  }
  if (path->rotation_rad != 0.0 && can_rotate) {
    const double angle_rad = std::min(std::abs(path->rotation_rad), free_rad);
    return Twist{0.0, sign(side) * brake.stoppable_rad_s(angle_rad)};
  }
  trail_.forget_ahead(now.T_odom_base);
  const double distance_m =
      free_distance_backwards(now.points_base, path->curvature, body_, kMarginM) - kMarginM;
  if (distance_m < kMinDistanceM) {
    end();
    return std::nullopt;
  }
  const double forward_mps = -std::min(params_.speed_mps, brake.stoppable_mps(distance_m));
  return Twist{forward_mps, forward_mps * path->curvature};
}

}  // namespace nodmap::navigator
