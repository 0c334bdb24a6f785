// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "common/geometry/se2.hpp"
#include "common/robot/footprint.hpp"
#include "modules/navigator/obstacle_points.hpp"

namespace nodmap::navigator {

/// The area that the robot does not leave: a polygon in the frame map, with holes where it must not
/// be. Its boundary is an obstacle that no laser sees: Brake, the rollouts and the planner keep the
/// whole body off it, as off a wall.
class Geofence {
 public:
  /// `wkt`: the polygon as well-known text (OGC), metres, frame map:
  /// "POLYGON((x y, x y, x y, ...), (x y, x y, x y, ...))", the outer ring first, then the holes.
  /// Rings may run either way round and need not repeat their first corner. Throws
  /// params::ParamError if this is not the text of a polygon, if edges cross, or if a corner is
  /// farther than 1000 km from the origin.
  explicit Geofence(const std::string& wkt);

  /// Whether a place lies inside. The boundary does not.
  [[nodiscard]] bool contains(const Eigen::Vector2d& p_map) const;

  /// Whether the whole body lies inside. It may touch the boundary.
  [[nodiscard]] bool contains(const geometry::SE2& T_map_base, const robot::Footprint& body) const;

  /// Points on the boundary within `radius_m` of a place, so close together (2 cm) that no body
  /// fits between them. Frame map.
  [[nodiscard]] Points boundary_near(const Eigen::Vector2d& p_map, double radius_m) const;

 private:
  struct Polygon;  // Boost.Geometry's, which is slow to compile

  std::shared_ptr<const Polygon> polygon_;
};

}  // namespace nodmap::navigator
