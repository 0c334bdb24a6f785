// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/corridor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace {

using geometry::kPi;

constexpr double kNever = std::numeric_limits<double>::infinity();
/// Arcs flatter than this are straight: 5 m on, they are 1.2 cm beside the line.
constexpr double kStraightCurvature = 1e-3;
/// Where the robot stands there is nothing else: a point so deep within the body is an error of the
/// map (odometry has drifted since it was seen), and would hold the robot for ever.
constexpr double kImpossibleDepthM = 0.03;
/// What is left of the margin for points that are within it already.
constexpr double kTightMarginM = 0.005;

/// A motion of the robot: about the point (0, center_y) of base, +1 to the left, -1 to the right.
struct Rotation {
  double center_y = 0.0;
  double side = 1.0;
};

/// Angle in [0, 2 pi) by which the robot turns until a point at `from_rad` about the centre of
/// rotation comes to `to_rad`: seen from the robot, the world turns the other way.
double angle_until(double from_rad, double to_rad, double side) {
  const double turn_rad = (from_rad - to_rad) * side;
  return turn_rad < 0.0 ? turn_rad + 2.0 * kPi : turn_rad;
}

/// Turn until a point outside the rectangle meets it. On its circle about the centre of rotation it
/// can enter only where the circle cuts the lines of the edges.
double turn_until_met(const Eigen::Vector2d& p, const Rotation& rotation, const Footprint& body) {
  const double radius_sq =
      p.x() * p.x() + (p.y() - rotation.center_y) * (p.y() - rotation.center_y);
  const double from_rad = std::atan2(p.y() - rotation.center_y, p.x());
  double turn_rad = kNever;
  const auto consider = [&](double x, double y_from_center) {
    turn_rad =
        std::min(turn_rad, angle_until(from_rad, std::atan2(y_from_center, x), rotation.side));
  };
  for (const double x : {body.half_length_m, -body.half_length_m}) {
    const double rest = radius_sq - x * x;
    for (const double y_from_center :
         {std::sqrt(std::max(rest, 0.0)), -std::sqrt(std::max(rest, 0.0))}) {
      if (rest >= 0.0 && std::abs(rotation.center_y + y_from_center) <= body.half_width_m) {
        consider(x, y_from_center);
      }
    }
  }
  for (const double y : {body.half_width_m, -body.half_width_m}) {
    const double y_from_center = y - rotation.center_y;
    const double rest = radius_sq - y_from_center * y_from_center;
    for (const double x : {std::sqrt(std::max(rest, 0.0)), -std::sqrt(std::max(rest, 0.0))}) {
      if (rest >= 0.0 && std::abs(x) <= body.half_length_m) {
        consider(x, y_from_center);
      }
    }
  }
  return turn_rad;
}

/// Whether a point at the body's border moves further in when the base moves by this twist (forward
/// and turn, any common scale).
bool moves_inward(const Eigen::Vector2d& p, double forward, double turn, const Footprint& body) {
  const Eigen::Vector2d velocity(-forward + turn * p.y(), -turn * p.x());
  const bool at_an_end = body.half_length_m - std::abs(p.x()) < body.half_width_m - std::abs(p.y());
  return at_an_end ? velocity.x() * p.x() < 0.0 : velocity.y() * p.y() < 0.0;
}

/// What one point leaves of a motion; `met` gives it for a rectangle that the point is outside of.
template <class Met>
double left_by_point(const Eigen::Vector2d& p, const Eigen::Vector2d& twist, const Footprint& body,
                     const Footprint& grown, const Met& met) {
  if (!grown.contains(p)) {
    return met(p, grown);
  }
  if (body.grown(-kImpossibleDepthM, -kImpossibleDepthM).contains(p)) {
    return kNever;
  }
  const Footprint tight = body.grown(kTightMarginM, kTightMarginM);
  if (!tight.contains(p)) {
    return met(p, tight);
  }
  return moves_inward(p, twist.x(), twist.y(), tight) ? 0.0 : kNever;
}

double straight_way(const Eigen::Vector2d& p, const Footprint& body) {
  const bool in_corridor = std::abs(p.y()) <= body.half_width_m && p.x() >= body.half_length_m;
  return in_corridor ? p.x() - body.half_length_m : kNever;
}

double arc_way(const Eigen::Vector2d& p, double curvature, const Footprint& body) {
  const double radius_m = std::abs(1.0 / curvature);
  const Rotation rotation{1.0 / curvature, std::copysign(1.0, curvature)};
  const double p_radius_m = std::hypot(p.x(), p.y() - rotation.center_y);
  // Outside the ring that the rectangle sweeps nothing is met: most points end here.
  if (p_radius_m > std::hypot(body.half_length_m, radius_m + body.half_width_m) ||
      p_radius_m < radius_m - body.half_width_m) {
    return kNever;
  }
  const double turn_rad = turn_until_met(p, rotation, body);
  return turn_rad <= kPi ? turn_rad * radius_m : kNever;
}

}  // namespace

double free_way(const Points& points_base, double curvature, const Footprint& body,
                double side_margin_m) {
  const Footprint grown = body.grown(0.0, side_margin_m);
  double way_m = kNever;
  for (const Eigen::Vector2d& p : points_base) {
    way_m = std::min(way_m, left_by_point(p, {1.0, curvature}, body, grown,
                                          [&](const Eigen::Vector2d& q, const Footprint& shape) {
                                            return std::abs(curvature) < kStraightCurvature
                                                       ? straight_way(q, shape)
                                                       : arc_way(q, curvature, shape);
                                          }));
  }
  return way_m;
}

double free_way_behind(const Points& points_base, double curvature, const Footprint& body,
                       double side_margin_m) {
  // Seen in a mirror across the axle the robot drives forwards on the same circle.
  Points mirrored = points_base;
  for (Eigen::Vector2d& p : mirrored) {
    p.x() = -p.x();
  }
  return free_way(mirrored, curvature, body, side_margin_m);
}

double free_turn(const Points& points_base, double side, const Footprint& body, double margin_m) {
  const Footprint grown = body.grown(margin_m, margin_m);
  const double circle_m = std::hypot(grown.half_length_m, grown.half_width_m);
  double turn_rad = kNever;
  for (const Eigen::Vector2d& p : points_base) {
    if (p.norm() >= circle_m) {
      continue;
    }
    turn_rad = std::min(turn_rad, left_by_point(p, {0.0, side}, body, grown,
                                                [&](const Eigen::Vector2d& q, const Footprint& s) {
                                                  return turn_until_met(q, {0.0, side}, s);
                                                }));
  }
  return turn_rad;
}

}  // namespace nodmap::navigator
