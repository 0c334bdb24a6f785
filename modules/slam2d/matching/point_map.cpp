// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/matching/point_map.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace nodmap::slam2d {
namespace {

constexpr double kCellSizeM = 0.25;
// A search begins with this radius, within which there usually is a point, and grows by this
// factor.
constexpr double kFirstReachM = 0.125;
constexpr double kReachGrowth = 2.0;
constexpr double kMaxLineThickness = 0.3;  // width over length
constexpr double kMinNeighbours = 3.0;     // of a line, with the point itself
// The cosine of the angle between normals that a rotation by 0.1 rad may make similar.
constexpr double kMinLaterCosine = 0.41;

// std::floor is a dozen instructions without SSE4.
std::int32_t floor_to_int(double value) {
  const auto truncated = static_cast<std::int32_t>(value);
  return truncated - (static_cast<double>(truncated) > value ? 1 : 0);
}

bool is_finite(const OrientedPoint& point) {
  return point.p.allFinite() && point.normal.allFinite();
}

}  // namespace

void PointMap::Moments::add(const Eigen::Vector2d& d) {
  n += 1.0;
  x += d.x();
  y += d.y();
  xx += d.x() * d.x();
  xy += d.x() * d.y();
  yy += d.y() * d.y();
}

std::size_t PointMap::CellHash::operator()(const CellIndex& index) const {
  const std::uint64_t key =
      (static_cast<std::uint64_t>(static_cast<std::uint32_t>(index.x)) << 32U) |
      static_cast<std::uint32_t>(index.y);
  // The table uses the low bits of the hash. Those of the product depend on y alone, those from bit
  // 32 on depend on both.
  return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> 32U);
}

PointMap::CellIndex PointMap::cell_index(const Eigen::Vector2d& p) {
  return {floor_to_int(p.x() / kCellSizeM), floor_to_int(p.y() / kCellSizeM)};
}

// Shifts and masks round down for negative indices, too.
PointMap::CellIndex PointMap::tile_index(CellIndex cell) {
  static_assert(kTileCells == 8);
  return {cell.x >> 3, cell.y >> 3};
}

const PointMap::Tile* PointMap::find_tile(CellIndex tile) const {
  const auto found = tile_numbers_.find(tile);
  return found == tile_numbers_.end() ? nullptr : &tiles_[found->second];
}

void PointMap::enter(const Eigen::Vector2d& p, std::uint32_t index) {
  const CellIndex cell = cell_index(p);
  const auto [number, is_new] =
      tile_numbers_.try_emplace(tile_index(cell), static_cast<std::uint32_t>(tiles_.size()));
  if (is_new) {
    tiles_.emplace_back();
  }
  Tile& tile = tiles_[number->second];
  const auto row = static_cast<std::size_t>(cell.y & (kTileCells - 1));
  const auto column = static_cast<std::size_t>(cell.x & (kTileCells - 1));
  const std::span<std::uint32_t> begins_after =
      std::span(tile.begins).subspan(kTileCells * row + column + 1);
  const auto end_of_cell = static_cast<std::ptrdiff_t>(begins_after.front());
  tile.places.insert(tile.places.begin() + end_of_cell, p);
  tile.indices.insert(tile.indices.begin() + end_of_cell, index);
  for (std::uint32_t& begin : begins_after) {
    ++begin;
  }
}

bool PointMap::find_neighbours(const OrientedPoint& point) {
  const double line_m2 = params_.line_radius_m * params_.line_radius_m;
  const double new_m2 = params_.new_point_distance_m * params_.new_point_distance_m;
  const double radius_m = std::max(params_.line_radius_m, params_.new_point_distance_m);
  neighbours_.clear();
  bool is_known = false;
  for_each_around(point.p, radius_m, [&](const Eigen::Vector2d& p, std::uint32_t index) {
    const double squared_m2 = (point.p - p).squaredNorm();
    is_known = is_known || squared_m2 <= new_m2;
    if (squared_m2 <= line_m2 && have_similar_normals(point.normal, points_[index].point.normal)) {
      neighbours_.push_back(index);
    }
  });
  return is_known;
}

// Lines are fitted once, after the last point: they are not needed earlier.
void PointMap::insert(std::span<const OrientedPoint> points) {
  for (const OrientedPoint& point : points) {
    if (!is_finite(point)) {
      continue;
    }
    if (find_neighbours(point)) {
      refine_neighbours(point);
    } else {
      add_point(point);
    }
  }
  fit_changed_lines();
}

void PointMap::add(const OrientedPoint& point) {
  if (is_finite(point)) {
    find_neighbours(point);
    add_point(point);
    fit_changed_lines();
  }
}

void PointMap::add_point(const OrientedPoint& point) {
  const auto added = static_cast<std::uint32_t>(points_.size());
  points_.push_back({point, point.p, Eigen::Vector2d::Zero()});
  moments_.emplace_back();
  measure(added, Eigen::Vector2d::Zero());
  for (const std::uint32_t neighbour : neighbours_) {
    const Eigen::Vector2d d = point.p - points_[neighbour].point.p;
    measure(neighbour, d);
    moments_[added].add(-d);
  }
  enter(point.p, added);
}

void PointMap::refine_neighbours(const OrientedPoint& point) {
  for (const std::uint32_t neighbour : neighbours_) {
    measure(neighbour, point.p - points_[neighbour].point.p);
  }
}

void PointMap::measure(std::uint32_t index, const Eigen::Vector2d& d) {
  Moments& moments = moments_[index];
  moments.add(d);
  if (!moments.has_changed) {
    moments.has_changed = true;
    changed_.push_back(index);
  }
}

void PointMap::fit_changed_lines() {
  for (const std::uint32_t index : changed_) {
    moments_[index].has_changed = false;
    fit_line(index);
  }
  changed_.clear();
}

void PointMap::fit_line(std::uint32_t index) {
  const Moments& m = moments_[index];
  MapPoint& point = points_[index];
  point.line_point = point.point.p;
  point.line_normal = point.point.normal;
  if (m.n < kMinNeighbours) {
    return;
  }
  point.line_normal.setZero();
  // Total least squares: the line through the mean along the larger axis of the covariance.
  const Eigen::Vector2d mean(m.x / m.n, m.y / m.n);
  const double xx = m.xx / m.n - mean.x() * mean.x();
  const double xy = m.xy / m.n - mean.x() * mean.y();
  const double yy = m.yy / m.n - mean.y() * mean.y();
  const double middle = 0.5 * (xx + yy);
  const double half_gap = std::hypot(0.5 * (xx - yy), xy);
  if (middle - half_gap > kMaxLineThickness * kMaxLineThickness * (middle + half_gap)) {
    return;
  }
  const double angle_rad = 0.5 * std::atan2(2.0 * xy, xx - yy);
  point.line_point += mean;
  point.line_normal = {-std::sin(angle_rad), std::cos(angle_rad)};
  if (point.line_normal.dot(point.point.normal) < 0.0) {
    point.line_normal = -point.line_normal;
  }
}

const MapPoint* PointMap::nearest(const OrientedPoint& point, double max_distance_m) const {
  for (double reach_m = std::min(kFirstReachM, max_distance_m);;
       reach_m = std::min(kReachGrowth * reach_m, max_distance_m)) {
    NearestOf search{.point = point, .nearest_m2 = reach_m * reach_m};
    for_each_around(point.p, reach_m, [&](const Eigen::Vector2d& place, std::uint32_t index) {
      if ((place - point.p).squaredNorm() <= search.nearest_m2) {
        search.consider(points_[index]);
      }
    });
    if (search.nearest != nullptr || reach_m >= max_distance_m) {
      return search.nearest;
    }
  }
}

// One search: the nearest points found so far. The others go into `around`.
struct PointMap::Search {
  const OrientedPoint& point;
  Neighbourhood& around;
  double nearest_m2 = 0.0;  // of the nearest with a similar normal; at first of the reach
  double other_m2 = 0.0;    // of the nearest of the others; at first of the reach
  // Of the nearest point that did not fit into `others`; at first of the reach.
  double forgotten_m2 = 0.0;
  const MapPoint* nearest = nullptr;

  void consider(const MapPoint& map_point, double squared_m2) {
    const Eigen::Vector2d& normal = map_point.point.normal;
    if (squared_m2 <= nearest_m2 && have_similar_normals(point.normal, normal)) {
      if (nearest != nullptr) {
        remember(*nearest, nearest_m2);
      }
      nearest_m2 = squared_m2;
      nearest = &map_point;
    } else if (have_similar_normals(point.normal, normal, kMinLaterCosine)) {
      remember(map_point, squared_m2);
    }
  }

  void remember(const MapPoint& map_point, double squared_m2) {
    other_m2 = std::min(other_m2, squared_m2);
    if (around.num_others == Neighbourhood::kMaxOthers) {
      forgotten_m2 = std::min(forgotten_m2, squared_m2);
    } else {
      around.others[around.num_others++] = &map_point;
    }
  }
};

void PointMap::read_block(const Eigen::Vector2d& p, double radius_m, Block& block) const {
  const CellIndex low = cell_index(p.array() - radius_m);
  const CellIndex high = cell_index(p.array() + radius_m);
  if (block.low_ == low && block.high_ == high) {
    return;
  }
  block.low_ = low;
  block.high_ = high;
  block.entries_.clear();
  for_each_around(p, radius_m, [&](const Eigen::Vector2d& place, std::uint32_t index) {
    block.entries_.push_back({place, &points_[index]});
  });
  block.in_reach_.resize(block.entries_.size());
}

// Without branches: which points are in reach cannot be foretold.
std::span<const PointMap::Block::InReach> PointMap::find_in_reach(const Eigen::Vector2d& p,
                                                                  double reach_m2, Block& block) {
  Block::InReach* const begin = block.in_reach_.data();
  Block::InReach* end = begin;
  for (const Block::Entry& entry : block.entries_) {
    const double squared_m2 = (entry.place - p).squaredNorm();
    *end = {entry.point, squared_m2};
    end += squared_m2 <= reach_m2 ? 1 : 0;
  }
  return {begin, end};
}

void PointMap::look_around(const OrientedPoint& point, double max_distance_m, Neighbourhood& around,
                           Block& block) const {
  for (double reach_m = std::min(kFirstReachM, max_distance_m);;
       reach_m = std::min(kReachGrowth * reach_m, max_distance_m)) {
    const double reach_m2 = reach_m * reach_m;
    around.num_others = 0;
    Search search{point, around, reach_m2, reach_m2, reach_m2};
    read_block(point.p, reach_m, block);
    for (const Block::InReach& in_reach : find_in_reach(point.p, reach_m2, block)) {
      search.consider(*in_reach.point, in_reach.squared_m2);
    }
    if (search.nearest != nullptr || reach_m >= max_distance_m) {
      around.nearest = search.nearest;
      around.center = point;
      around.free_m = std::sqrt(search.other_m2);
      around.known_m = std::sqrt(search.forgotten_m2);
      return;
    }
  }
}

}  // namespace nodmap::slam2d
