// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/known_map.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace nodmap::slam2d {
namespace {

constexpr double kLikelihoodCellM = 0.1;
constexpr double kNormalRadiusM = 0.15;
// A point within this distance of an occupied cell counts as on the wall: poses are off by a few
// centimetres, and walls in grids are a cell or two thick.
constexpr double kNearWallM = 0.12;
// The last part of a ray is not checked: it may graze the wall at which it ends.
constexpr double kFreeBeforeHitM = 0.4;

/// Towards the free cells around an occupied one; zero where they are on all sides or on none.
Eigen::Vector2d normal_at(const TrinaryGrid& grid, int x, int y) {
  const int reach = std::max(1, static_cast<int>(kNormalRadiusM / grid.cell_size_m));
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      if (grid.at(x + dx, y + dy) == CellState::kFree) {
        sum += Eigen::Vector2d(dx, dy) / std::hypot(dx, dy);
      }
    }
  }
  return sum.norm() < 1.0 ? Eigen::Vector2d::Zero()
                          : Eigen::Vector2d(grid.T_map_grid.rotation() * sum.normalized());
}

bool is_beside_free(const TrinaryGrid& grid, int x, int y) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (grid.at(x + dx, y + dy) == CellState::kFree) {
        return true;
      }
    }
  }
  return false;
}

PointMap surfaces_of(const TrinaryGrid& grid, const MapParams& params) {
  PointMap points(params);
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      if (grid.at(x, y) == CellState::kOccupied && is_beside_free(grid, x, y)) {
        points.add({grid.middle_of(x, y), normal_at(grid, x, y)});
      }
    }
  }
  return points;
}

LikelihoodGrid likelihood_of(const PointMap& map) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(map.points().size());
  for (const MapPoint& point : map.points()) {
    points.push_back(point.point.p);
  }
  return {points, kLikelihoodCellM, std::numeric_limits<double>::infinity()};
}

}  // namespace

TrinaryGrid trinary(const OccupancyGrid& grid) {
  TrinaryGrid states{.cell_size_m = grid.cell_size_m(),
                     .T_map_grid = {grid.origin().x(), grid.origin().y(), 0.0},
                     .width = grid.width(),
                     .height = grid.height()};
  for (int y = 0; y < grid.height(); ++y) {
    for (int x = 0; x < grid.width(); ++x) {
      states.cells.push_back(grid.occupancy(x, y) == OccupancyGrid::kUnknown ? CellState::kUnknown
                             : grid.is_occupied(x, y)                        ? CellState::kOccupied
                                                                             : CellState::kFree);
    }
  }
  return states;
}

KnownMap::KnownMap(TrinaryGrid grid, const MapParams& params)
    : grid_(std::move(grid)),
      points_(surfaces_of(grid_, params)),
      likelihood_(likelihood_of(points_)) {
  std::vector<Eigen::Vector2d> places;
  Eigen::AlignedBox2d box;
  for (int y = 0; y < grid_.height; ++y) {
    for (int x = 0; x < grid_.width; ++x) {
      if (grid_.at(x, y) == CellState::kFree) {
        places.push_back(grid_.middle_of(x, y));
        box.extend(places.back());
      }
    }
  }
  likelihood_.set_allowed(places);
  if (!places.empty()) {
    window_.T_map_base = {box.center().x(), box.center().y(), 0.0};
    window_.distance_m = 0.5 * box.sizes().maxCoeff() + kLikelihoodCellM;
  }
  window_.rotation_rad = geometry::kPi;
}

GridFit KnownMap::fit(std::span<const OrientedPoint> scan,
                      const Eigen::Vector2d& sensor_origin_base,
                      const geometry::SE2& T_map_base) const {
  const geometry::SE2 T_grid_base = grid_.T_map_grid.inverse() * T_map_base;
  const Eigen::Vector2d origin = T_grid_base * sensor_origin_base;
  const auto state_at = [this](const Eigen::Vector2d& p_grid) {
    const Eigen::Vector2d cell = p_grid / grid_.cell_size_m;
    return grid_.at(static_cast<int>(std::floor(cell.x())), static_cast<int>(std::floor(cell.y())));
  };
  const int reach = static_cast<int>(std::ceil(kNearWallM / grid_.cell_size_m));
  double on_walls = 0.0;
  double through_walls = 0.0;
  for (const OrientedPoint& point : scan) {
    const Eigen::Vector2d end = T_grid_base * point.p;
    bool is_on_wall = false;
    for (int dy = -reach; dy <= reach && !is_on_wall; ++dy) {
      for (int dx = -reach; dx <= reach && !is_on_wall; ++dx) {
        is_on_wall =
            state_at(end + grid_.cell_size_m * Eigen::Vector2d(dx, dy)) == CellState::kOccupied;
      }
    }
    on_walls += is_on_wall ? 1.0 : 0.0;
    const double range_m = (end - origin).norm();
    const Eigen::Vector2d ray = (end - origin) / std::max(range_m, 1e-9);
    for (double at_m = 0.0; at_m < range_m - kFreeBeforeHitM; at_m += grid_.cell_size_m) {
      if (state_at(origin + at_m * ray) == CellState::kOccupied) {
        through_walls += 1.0;
        break;
      }
    }
  }
  const double n = std::max<double>(1.0, static_cast<double>(scan.size()));
  return {on_walls / n, through_walls / n};
}

}  // namespace nodmap::slam2d
