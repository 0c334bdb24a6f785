// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/behaviours/corridor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace {

using geometry::kPi;

constexpr double kNever = std::numeric_limits<double>::infinity();
// Arcs flatter than this count as straight: after 5 m they are 1.2 cm beside the line.
constexpr double kStraightCurvature = 1e-3;
// The margin that remains for points that are within the margin already.
constexpr double kTightMarginM = 0.005;

// A rotation of the robot about the point (0, center_y) of base.
struct Rotation {
  double center_y = 0.0;
  Side side = Side::kLeft;
};

// Angle in [0, 2 pi) by which the robot rotates until a point at `from_rad` about the centre of
// rotation comes to `to_rad`: in base, the world rotates the other way.
double angle_until(double from_rad, double to_rad, Side side) {
  const double angle_rad = (from_rad - to_rad) * sign(side);
  return angle_rad < 0.0 ? angle_rad + 2.0 * kPi : angle_rad;
}

// Rotation until a point outside the rectangle touches it. On its circle about the centre of
// rotation it can enter only where the circle cuts the lines of the edges.
double rotation_until_touched(const Eigen::Vector2d& p, const Rotation& rotation,
                              const robot::Footprint& body) {
  const double radius_sq =
      p.x() * p.x() + (p.y() - rotation.center_y) * (p.y() - rotation.center_y);
  const double from_rad = std::atan2(p.y() - rotation.center_y, p.x());
  double angle_rad = kNever;
  const auto consider = [&](double x, double y_from_center) {
    angle_rad =
        std::min(angle_rad, angle_until(from_rad, std::atan2(y_from_center, x), rotation.side));
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
  return angle_rad;
}

// Whether a point at the body's border moves further in when the base moves by this twist (forward
// and yaw, any common scale).
bool moves_inward(const Eigen::Vector2d& p, double forward, double yaw,
                  const robot::Footprint& body) {
  const Eigen::Vector2d velocity(-forward + yaw * p.y(), -yaw * p.x());
  const bool at_an_end = body.half_length_m - std::abs(p.x()) < body.half_width_m - std::abs(p.y());
  return at_an_end ? velocity.x() * p.x() < 0.0 : velocity.y() * p.y() < 0.0;
}

// How far one point allows a motion to go. `until_touched`: computes it for a rectangle that the
// point is outside of.
template <class UntilTouched>
double free_by_point(const Eigen::Vector2d& p, const Eigen::Vector2d& twist,
                     const robot::Footprint& body, const robot::Footprint& grown,
                     const UntilTouched& until_touched) {
  if (!grown.contains(p)) {
    return until_touched(p, grown);
  }
  if (is_error_of_map(p, body)) {
    return kNever;
  }
  const robot::Footprint tight = body.grown(kTightMarginM, kTightMarginM);
  if (!tight.contains(p)) {
    return until_touched(p, tight);
  }
  return moves_inward(p, twist.x(), twist.y(), tight) ? 0.0 : kNever;
}

double straight_distance(const Eigen::Vector2d& p, const robot::Footprint& body) {
  const bool in_corridor = std::abs(p.y()) <= body.half_width_m && p.x() >= body.half_length_m;
  return in_corridor ? p.x() - body.half_length_m : kNever;
}

double arc_distance(const Eigen::Vector2d& p, double curvature, const robot::Footprint& body) {
  const double radius_m = std::abs(1.0 / curvature);
  const Rotation rotation{1.0 / curvature, side_of(curvature)};
  // A point outside the ring that the rectangle sweeps is never touched. This is the case for most
  // points.
  const double squared_radius = Eigen::Vector2d(p.x(), p.y() - rotation.center_y).squaredNorm();
  const double inner_m = std::max(0.0, radius_m - body.half_width_m);
  const Eigen::Vector2d outer_corner(body.half_length_m, radius_m + body.half_width_m);
  if (squared_radius > outer_corner.squaredNorm() || squared_radius < inner_m * inner_m) {
    return kNever;
  }
  const double angle_rad = rotation_until_touched(p, rotation, body);
  return angle_rad <= kPi ? angle_rad * radius_m : kNever;
}

}  // namespace

bool is_error_of_map(const Eigen::Vector2d& p_base, const robot::Footprint& body) {
  return body.grown(-kErrorOfMapM, -kErrorOfMapM).contains(p_base);
}

double free_distance(const Points& points_base, double curvature, const robot::Footprint& body,
                     double side_margin_m) {
  const robot::Footprint grown = body.grown(0.0, side_margin_m);
  double distance_m = kNever;
  for (const Eigen::Vector2d& p : points_base) {
    distance_m = std::min(
        distance_m, free_by_point(p, {1.0, curvature}, body, grown,
                                  [&](const Eigen::Vector2d& q, const robot::Footprint& shape) {
                                    return std::abs(curvature) < kStraightCurvature
                                               ? straight_distance(q, shape)
                                               : arc_distance(q, curvature, shape);
                                  }));
  }
  return distance_m;
}

double free_distance_backwards(const Points& points_base, double curvature,
                               const robot::Footprint& body, double side_margin_m) {
  // Driving backwards is driving forwards on the same circle, mirrored across the axle.
  Points mirrored = points_base;
  for (Eigen::Vector2d& p : mirrored) {
    p.x() = -p.x();
  }
  return free_distance(mirrored, curvature, body, side_margin_m);
}

double free_rotation(const Points& points_base, Side side, const robot::Footprint& body,
                     double margin_m) {
  const robot::Footprint grown = body.grown(margin_m, margin_m);
  const double circle_m = std::hypot(grown.half_length_m, grown.half_width_m);
  double angle_rad = kNever;
  for (const Eigen::Vector2d& p : points_base) {
    if (p.norm() >= circle_m) {
      continue;
    }
    angle_rad =
        std::min(angle_rad, free_by_point(p, {0.0, sign(side)}, body, grown,
                                          [&](const Eigen::Vector2d& q, const robot::Footprint& s) {
                                            return rotation_until_touched(q, {0.0, side}, s);
                                          }));
  }
  return angle_rad;
}

}  // namespace nodmap::navigator
