// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/geofence.hpp"

#include <algorithm>

// Boost.Geometry includes a deprecated header itself.
#define BOOST_ALLOW_DEPRECATED_HEADERS
#include <boost/geometry.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <cmath>
#include <utility>

#include "common/params/params.hpp"

namespace nodmap::navigator {
namespace {

namespace bg = boost::geometry;
using Corner = bg::model::d2::point_xy<double>;

constexpr double kPointSpacingM = 0.02;
// Poses farther from the origin are refused, too: see node::read_pose().
constexpr double kFarthestCornerM = 1e6;

// The points of one edge within a circle; its end is the next one's beginning.
void append_edge(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                 const Eigen::Vector2d& middle, double radius_m, Points& points) {
  const double length_m = (to - from).norm();
  if (length_m == 0.0) {
    return;  // a repeated corner
  }
  const Eigen::Vector2d direction = (to - from) / length_m;
  const double along_m = direction.dot(middle - from);
  const double aside_m = (middle - from - along_m * direction).norm();
  if (aside_m > radius_m) {
    return;
  }
  const double half_m = std::sqrt(radius_m * radius_m - aside_m * aside_m);
  // Always the same points of an edge: the boundary does not move with the robot.
  const double first = std::ceil(std::max(0.0, along_m - half_m) / kPointSpacingM);
  for (double i = first; i * kPointSpacingM < std::min(length_m, along_m + half_m); ++i) {
    points.emplace_back(from + i * kPointSpacingM * direction);
  }
}

const char* describe(bg::validity_failure_type failure) {
  switch (failure) {
    case bg::failure_few_points:
    case bg::failure_wrong_topological_dimension:
      return "each ring needs three corners that are not on one line";
    case bg::failure_interior_rings_outside:
    case bg::failure_nested_interior_rings:
    case bg::failure_disconnected_interior:
      return "a hole is not inside the outer ring, or not apart from the others";
    default:
      return "its boundary crosses or touches itself";
  }
}

}  // namespace

struct Geofence::Polygon : bg::model::polygon<Corner> {};

Geofence::Geofence(const std::string& wkt) {
  const std::string where = "geofence '" + wkt + "': ";
  auto polygon = std::make_shared<Polygon>();
  auto& shape = static_cast<bg::model::polygon<Corner>&>(*polygon);
  try {
    bg::read_wkt(wkt, shape);
  } catch (const bg::exception&) {
    throw params::ParamError(where + "must be POLYGON((X Y, X Y, ...)), and more rings for holes");
  }
  bg::correct(shape);
  bg::for_each_point(shape, [&](const Corner& corner) {
    if (!(std::hypot(corner.x(), corner.y()) <= kFarthestCornerM)) {
      throw params::ParamError(where + "a corner is farther than 1000 km from the origin");
    }
  });
  bg::validity_failure_type failure{};
  if (!bg::is_valid(shape, failure)) {
    throw params::ParamError(where + describe(failure));
  }
  polygon_ = std::move(polygon);
}

bool Geofence::contains(const Eigen::Vector2d& p_map) const {
  const bg::model::polygon<Corner>& shape = *polygon_;
  return bg::within(Corner(p_map.x(), p_map.y()), shape);
}

bool Geofence::contains(const geometry::SE2& T_map_base, const robot::Footprint& body) const {
  const bg::model::polygon<Corner>& shape = *polygon_;
  const double x = body.half_length_m;
  const double y = body.half_width_m;
  bg::model::ring<Corner> outline;
  // Clockwise and closed, as Boost.Geometry has them.
  for (const Eigen::Vector2d& corner_base :
       {Eigen::Vector2d(x, y), Eigen::Vector2d(x, -y), Eigen::Vector2d(-x, -y),
        Eigen::Vector2d(-x, y), Eigen::Vector2d(x, y)}) {
    const Eigen::Vector2d corner_map = T_map_base * corner_base;
    outline.emplace_back(corner_map.x(), corner_map.y());
  }
  return bg::within(outline, shape);
}

Points Geofence::boundary_near(const Eigen::Vector2d& p_map, double radius_m) const {
  const bg::model::polygon<Corner>& shape = *polygon_;
  Points points_map;
  bg::for_each_segment(shape, [&](const auto& edge) {
    append_edge({bg::get<0, 0>(edge), bg::get<0, 1>(edge)},
                {bg::get<1, 0>(edge), bg::get<1, 1>(edge)}, p_map, radius_m, points_map);
  });
  return points_map;
}

}  // namespace nodmap::navigator
