// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/back_out.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "modules/navigator/behaviours/corridor.hpp"
#include "modules/navigator/surroundings/rear_view.hpp"

namespace nodmap::navigator {
namespace {

// A robot that has not got farther than this in this time is stuck. Squeezing at 0.1 m/s it would.
constexpr double kStuckM = 0.05;
constexpr time::Duration kStuck = 5s;
// The robot can turn round if it can rotate by this much to one side.
constexpr double kTurnRad = geometry::deg_to_rad(150.0);
// Margin of that rotation, with which the local planner rotates, and with which backing out ends:
// otherwise the noise of the ranges would use up the room at once.
constexpr double kTurnMarginM = 0.025;
constexpr double kAmpleTurnMarginM = 0.055;
// Distance kept behind the body: the error of a range finder, about a tenth of what it measures, at
// the distance at which the robot stops, and what it moves between two readings.
constexpr double kBehindMarginM = 0.05;
// Margin beside the body, and the one that it keeps where there is room.
constexpr double kBesideMarginM = 0.015;
constexpr double kAmpleBesideMarginM = 0.045;
// Beyond this distance room does not count: the range finders do not see what is beside it.
constexpr double kAheadM = 0.3;
constexpr std::array kCurvatures{0.0, 0.3, -0.3, 0.7, -0.7, 1.5, -1.5};
// A tighter arc must gain this much, metres for each 1/m.
constexpr double kPriceOfBend = 0.03;
constexpr double kMinBackingMps = 0.01;

}  // namespace

// The base counts a wheel that stands still as stalled only above 0.05 m/s, and a slower body does
// not push away what it touches.
BackOut::BackOut(const NavigatorParams& params)
    : body_(params.robot.body.footprint()),
      brake_(params, true),
      speed_mps_(0.5 * params.back_up.speed_mps),
      without_progress_(kStuck) {}

std::optional<Decision> BackOut::step(const Situation& now) {
  const RearView* rear = now.rear_view;
  if (rear == nullptr || !rear->is_looking(now.stamp) || !now.people.empty()) {
    is_active_ = false;
    T_odom_stuck_.reset();
    return std::nullopt;
  }
  const Points points_base = with_rear_view(now).points_base;
  if (can_turn_round(points_base)) {
    is_active_ = false;
    T_odom_stuck_.reset();
    return std::nullopt;
  }
  is_active_ = is_active_ || counts_as_stuck(now);
  if (!is_active_ || now.forward_mps > kMinSpeedMps) {
    return std::nullopt;
  }
  const double curvature = curvature_with_most_room(points_base);
  const double free_m = free_distance_backwards(points_base, curvature, body_, kBesideMarginM);
  const double distance_m = std::min(std::min(free_m, RearView::kReachM) - kBehindMarginM,
                                     rear->permitted_m(now.T_odom_base));
  const double speed_mps = std::min(speed_mps_, brake_.stoppable_mps(distance_m));
  if (speed_mps < kMinBackingMps) {
    return std::nullopt;
  }
  has_begun_ = true;
  return backing(speed_mps, curvature, Why::kBacksOut);
}

bool BackOut::is_leaving(const Situation& now) const {
  return has_begun_ && now.rear_view != nullptr &&
         now.rear_view->permitted_m(now.T_odom_base) > 0.0;
}

bool BackOut::can_turn_round(const Points& points_base) const {
  const double margin_m = is_active_ ? kAmpleTurnMarginM : kTurnMarginM;
  return std::max(free_rotation(points_base, Side::kLeft, body_, margin_m),
                  free_rotation(points_base, Side::kRight, body_, margin_m)) >= kTurnRad;
}

// Time in which the robot was halted does not count.
bool BackOut::counts_as_stuck(const Situation& now) {
  without_progress_.record(now.stamp);
  if (!T_odom_stuck_ || !without_progress_.has_begun() ||
      geometry::distance_m(*T_odom_stuck_, now.T_odom_base) > kStuckM) {
    T_odom_stuck_ = now.T_odom_base;
    without_progress_.restart(now.stamp);
  }
  return without_progress_.is_over(now.stamp);
}

// Points within a margin already do not count for it, so each margin alone may take an arc for free
// on which the front swings into a wall.
double BackOut::curvature_with_most_room(const Points& points_base) const {
  const auto room_m = [&](double curvature) {
    const auto free_m = [&](double margin_m) {
      return std::min(kAheadM, free_distance_backwards(points_base, curvature, body_, margin_m));
    };
    return 2.0 * free_m(kBesideMarginM) + free_m(kAmpleBesideMarginM) -
           kPriceOfBend * std::abs(curvature);
  };
  return *std::ranges::max_element(kCurvatures, {}, room_m);
}

Situation with_rear_view(Situation now) {
  if (now.rear_view != nullptr) {
    const Points more = now.rear_view->points_base(now.T_odom_base);
    now.points_base.insert(now.points_base.end(), more.begin(), more.end());
  }
  return now;
}

}  // namespace nodmap::navigator
