// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/behaviours/steering.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::navigator {
namespace {

// The side changes only if a free direction on the other side is nearer by this angle.
constexpr double kOtherSideRad = geometry::deg_to_rad(30.0);

double longest_distance(const FreeSpace& space) {
  return *std::ranges::max_element(space.distance_m);
}

}  // namespace

Steering::Steering(const NavigatorParams& params)
    : body_(params.robot.body.footprint()),
      side_margin_m_(params.drive.side_margin_m),
      brake_(params),
      stop_margin_m_(params.robot.braking.stop_margin_m),
      params_(params.steer),
      turn_params_(params.turn) {}

std::optional<Decision> Steering::steer(const Situation& now) {
  const auto direction_rad = direction(preferred_space(now), now);
  if (!direction_rad) {
    return std::nullopt;
  }
  const auto arc = arc_towards(*direction_rad, now);
  if (!arc) {
    return std::nullopt;
  }
  return brake_.drive(*arc, *direction_rad, brake_.speed_limit(arc->curvature, now.max_forward_mps),
                      now);
}

FreeSpace seen_space(const FreeSpace& space, const Situation& now) {
  FreeSpace result = space;
  for (int degree = -FreeSpace::kHalf; degree <= FreeSpace::kHalf; ++degree) {
    if (!now.has_seen(FreeSpace::angle_rad(degree))) {
      result.at(degree) = 0.0;
    }
  }
  return result;
}

// Prefers corridors in which the robot can also turn. If there is none, those that it fits through
// will do.
FreeSpace Steering::preferred_space(const Situation& now) const {
  const auto space = [&](double margin_m) {
    return seen_space(measure_free_space(now.points_base, body_, margin_m), now);
  };
  const double turning_margin_m =
      body_.turning_radius_m() + turn_params_.margin_m - body_.half_width_m;
  const FreeSpace wide = space(turning_margin_m);
  return longest_distance(wide) >= turn_params_.until_free_m ? wide : space(side_margin_m_);
}

std::optional<double> Steering::direction(const FreeSpace& space, const Situation& now) {
  const double longest_m = longest_distance(space);
  if (longest_m < stop_margin_m_) {
    return std::nullopt;
  }
  // In narrow places the longest free distance must suffice.
  const double needed_m = std::min(params_.open_space_m, 0.8 * longest_m);
  return now.goal ? detour_.direction(space, now.points_base, *now.goal, needed_m)
                  : roaming_direction(space, needed_m);
}

std::optional<double> Steering::roaming_direction(const FreeSpace& space, double needed_m) {
  const auto alpha_rad = free_space_orientation(space, 0.0, params_.open_space_m);
  const FreeNeighbours near = free_neighbours(space, alpha_rad.value_or(0.0), needed_m);
  if (!near.left_rad || !near.right_rad || *near.left_rad == *near.right_rad) {
    const auto only = near.left_rad ? near.left_rad : near.right_rad;
    const bool alpha_is_free = near.left_rad && near.right_rad;
    const Side free_side = near.left_rad ? Side::kLeft : Side::kRight;
    roaming_side_ = alpha_is_free ? Side::kNone : free_side;
    return only;
  }
  // An obstacle at alpha is passed on the side first chosen.
  const double to_left_rad = *near.left_rad - alpha_rad.value_or(0.0);
  const double to_right_rad = alpha_rad.value_or(0.0) - *near.right_rad;
  const double left = to_left_rad - (roaming_side_ == Side::kLeft ? kOtherSideRad : 0.0);
  const double right = to_right_rad - (roaming_side_ == Side::kRight ? kOtherSideRad : 0.0);
  roaming_side_ = left <= right ? Side::kLeft : Side::kRight;
  return roaming_side_ == Side::kLeft ? near.left_rad : near.right_rad;
}

// The arc whose chord has this direction (pure pursuit), or a flatter one if that is blocked.
std::optional<Arc> Steering::arc_towards(double direction_rad, const Situation& now) const {
  const double chord_m =
      now.goal ? std::clamp(now.goal->distance_m(), 0.2, params_.chord_m) : params_.chord_m;
  const double curvature = 2.0 * std::sin(direction_rad) / chord_m;
  for (const double factor : {1.0, 0.5, 0.0}) {
    const Arc arc = brake_.measure_arc(factor * curvature, now);
    if (arc.speed_mps >= kMinSpeedMps) {
      return arc;
    }
  }
  return std::nullopt;
}

}  // namespace nodmap::navigator
