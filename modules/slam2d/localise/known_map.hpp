// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/slam2d/grid/trinary_grid.hpp"
#include "modules/slam2d/matching/correlative_match.hpp"
#include "modules/slam2d/matching/point_map.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// How a scan lies on the walls of a map, as fractions of its points.
struct WallFit {
  /// In an occupied cell or within 5 cm of one, so that noise in the map hardly changes it.
  double on_walls = 0.0;
  /// Measured through a wall: there are occupied cells in the way of the ray and of its parallels
  /// 6 cm to the left and to the right. A ray that grazes an edge or a post is not blocked.
  double through_walls = 0.0;

  /// 1 if all points lie on walls, and none behind one.
  [[nodiscard]] double score() const { return on_walls - through_walls; }
};

/// A finished map to localise in. It holds the surfaces twice, as points with normals for scan
/// matching and as a likelihood grid for the search of a pose, and the grid itself.
class KnownMap {
 public:
  KnownMap(TrinaryGrid grid, const MapParams& params);

  /// The cells at the border to free space, in map, with normals towards it.
  [[nodiscard]] const PointMap& points() const { return points_; }
  /// The likelihood grid of points(); the robot can only be in free cells.
  [[nodiscard]] const LikelihoodGrid& likelihood() const { return likelihood_; }
  [[nodiscard]] const TrinaryGrid& grid() const { return grid_; }
  /// The smallest window that holds all free places.
  [[nodiscard]] const SearchWindow& window() const { return window_; }

  /// How a scan lies on the walls if the robot is at `T_map_base`. `scan`: points in base.
  [[nodiscard]] WallFit fit_walls(std::span<const OrientedPoint> scan,
                                  const Eigen::Vector2d& sensor_origin_base,
                                  const geometry::SE2& T_map_base) const;

 private:
  /// Takes over the grid. `free`: the middles of all free cells, in map.
  KnownMap(const std::vector<Eigen::Vector2d>& free, TrinaryGrid& grid, const MapParams& params);

  /// From a place in the grid, in cells; empty outside.
  [[nodiscard]] std::optional<int> steps_to_occupied_at(const Eigen::Vector2d& cell) const;
  /// Whether a ray meets an occupied cell. In cells of the grid; `direction` has length 1.
  [[nodiscard]] bool meets_occupied(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction,
                                    double length) const;
  /// Whether a ray from the sensor to a point passes through a wall. Both in the grid, metres.
  [[nodiscard]] bool is_blocked(const Eigen::Vector2d& origin, const Eigen::Vector2d& point) const;

  TrinaryGrid grid_;
  /// For each cell the number of steps to the nearest occupied one, diagonals count as one; at most
  /// 255.
  std::vector<std::uint8_t> steps_to_occupied_;
  PointMap points_;
  LikelihoodGrid likelihood_;
  SearchWindow window_;
};

}  // namespace nodmap::slam2d
