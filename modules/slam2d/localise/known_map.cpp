// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/localise/known_map.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace nodmap::slam2d {
namespace {

constexpr double kLikelihoodCellM = 0.1;
constexpr double kNormalRadiusM = 0.1;
// The last part of a ray is not checked: it may graze the wall at which it ends.
constexpr double kFreeBeforeHitM = 0.4;
// What blocks a ray blocks its parallels at this distance, too. The error of a pose or of an edge
// in the map is smaller.
constexpr double kParallelM = 0.06;
// A point this near to an occupied cell lies on the wall. Noise of the laser, of the map and of a
// match together are smaller.
constexpr double kOnWallM = 0.05;

// Towards the free cells around an occupied one; zero where they are on all sides or on none.
Eigen::Vector2d normal_at(const TrinaryGrid& grid, int x, int y) {
  const int reach = std::max(1, static_cast<int>(std::lround(kNormalRadiusM / grid.cell_size_m)));
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

// One sweep forwards and one backwards, each over the neighbours that it has visited.
std::vector<std::uint8_t> steps_to_occupied(const TrinaryGrid& grid) {
  constexpr int kMax = 255;
  std::vector<std::uint8_t> steps(grid.cells.size(), kMax);
  const auto at = [&](int x, int y) -> std::uint8_t& {
    return steps[static_cast<std::size_t>(y) * static_cast<std::size_t>(grid.width) +
                 static_cast<std::size_t>(x)];
  };
  const auto visit = [&](int x, int y, int back) {
    int nearest = grid.at(x, y) == CellState::kOccupied ? 0 : int{at(x, y)};
    const auto step_from = [&](int from_x, int from_y) {
      const bool inside = from_x >= 0 && from_y >= 0 && from_x < grid.width && from_y < grid.height;
      nearest = inside ? std::min(nearest, at(from_x, from_y) + 1) : nearest;
    };
    step_from(x + back, y);
    for (int dx = -1; dx <= 1; ++dx) {
      step_from(x + dx, y + back);
    }
    at(x, y) = static_cast<std::uint8_t>(nearest);
  };
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      visit(x, y, -1);
    }
  }
  for (int y = grid.height - 1; y >= 0; --y) {
    for (int x = grid.width - 1; x >= 0; --x) {
      visit(x, y, 1);
    }
  }
  return steps;
}

LikelihoodGrid likelihood_of(const PointMap& map, const std::vector<Eigen::Vector2d>& free) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(map.points().size());
  for (const MapPoint& point : map.points()) {
    points.push_back(point.point.p);
  }
  return {points, kLikelihoodCellM, free};
}

// The middles of all free cells, in map.
std::vector<Eigen::Vector2d> free_places(const TrinaryGrid& grid) {
  std::vector<Eigen::Vector2d> places;
  // A large map has millions.
  places.reserve(static_cast<std::size_t>(std::ranges::count(grid.cells, CellState::kFree)));
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      if (grid.at(x, y) == CellState::kFree) {
        places.push_back(grid.middle_of(x, y));
      }
    }
  }
  return places;
}

// The smallest window that holds all places.
SearchWindow window_around(const std::vector<Eigen::Vector2d>& places) {
  SearchWindow window;
  window.rotation_rad = geometry::kPi;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& place : places) {
    box.extend(place);
  }
  if (!box.isEmpty()) {
    window.T_target_base = {box.center().x(), box.center().y(), 0.0};
    window.distance_m = 0.5 * box.sizes().maxCoeff() + kLikelihoodCellM;
  }
  return window;
}

}  // namespace

KnownMap::KnownMap(TrinaryGrid grid, const MapParams& params)
    : KnownMap(free_places(grid), grid, params) {}

KnownMap::KnownMap(const std::vector<Eigen::Vector2d>& free, TrinaryGrid& grid,
                   const MapParams& params)
    : grid_(std::move(grid)),
      steps_to_occupied_(steps_to_occupied(grid_)),
      points_(surfaces_of(grid_, params)),
      likelihood_(likelihood_of(points_, free)),
      window_(window_around(free)) {}

WallFit KnownMap::fit_walls(std::span<const OrientedPoint> scan,
                            const Eigen::Vector2d& sensor_origin_base,
                            const geometry::SE2& T_map_base) const {
  const int max_steps = std::max(1, static_cast<int>(std::lround(kOnWallM / grid_.cell_size_m)));
  const geometry::SE2 T_grid_base = grid_.T_map_grid.inverse() * T_map_base;
  const Eigen::Vector2d origin = T_grid_base * sensor_origin_base;
  int on_walls = 0;
  int through_walls = 0;
  for (const OrientedPoint& point : transformed(T_grid_base, scan)) {
    const std::optional<int> steps = steps_to_occupied_at(point.p / grid_.cell_size_m);
    on_walls += steps && *steps <= max_steps ? 1 : 0;
    through_walls += is_blocked(origin, point.p) ? 1 : 0;
  }
  const double num_points = std::max<double>(1.0, static_cast<double>(scan.size()));
  return {on_walls / num_points, through_walls / num_points};
}

bool KnownMap::is_blocked(const Eigen::Vector2d& origin, const Eigen::Vector2d& point) const {
  const Eigen::Vector2d ray = point - origin;
  const double range_m = ray.norm();
  const Eigen::Vector2d direction = ray / std::max(range_m, 1e-9);
  const Eigen::Vector2d aside = kParallelM * Eigen::Vector2d(-direction.y(), direction.x());
  const auto meets_occupied = [&](const Eigen::Vector2d& from) {
    return this->meets_occupied(from / grid_.cell_size_m, direction,
                                (range_m - kFreeBeforeHitM) / grid_.cell_size_m);
  };
  return meets_occupied(origin) && meets_occupied(origin + aside) && meets_occupied(origin - aside);
}

std::optional<int> KnownMap::steps_to_occupied_at(const Eigen::Vector2d& cell) const {
  if (!(cell.x() >= 0.0 && cell.y() >= 0.0 && cell.x() < grid_.width && cell.y() < grid_.height)) {
    return std::nullopt;
  }
  return steps_to_occupied_[static_cast<std::size_t>(cell.y()) *
                                static_cast<std::size_t>(grid_.width) +
                            static_cast<std::size_t>(cell.x())];
}

// In steps of one cell. None of as many steps as the nearest occupied cell is away can end in one.
bool KnownMap::meets_occupied(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction,
                              double length) const {
  for (double at = 0.0; at < length;) {
    const int steps = steps_to_occupied_at(origin + at * direction).value_or(1);
    if (steps == 0) {
      return true;
    }
    at += steps;
  }
  return false;
}

}  // namespace nodmap::slam2d
