// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/point_map.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::slam2d {
namespace {

// Large enough that most searches end in one cell, small enough that it holds a dozen points.
constexpr double kCellSizeM = 0.25;
constexpr std::size_t kFirstSlots = 1024;
constexpr double kSameSideCosine = 0.5;  // 60 degrees
constexpr double kMaxThickness = 0.3;    // of a line: its width over its length
constexpr double kMinNeighbours = 3.0;   // with the point itself

bool look_the_same_way(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.isZero(0.0) || b.isZero(0.0) || a.dot(b) > kSameSideCosine;
}

bool is_finite(const SurfacePoint& point) {
  return point.p.allFinite() && point.normal.allFinite();
}

std::size_t hash(std::int32_t x, std::int32_t y) {
  const std::uint64_t key = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32U) |
                            static_cast<std::uint32_t>(y);
  // A bit of the product knows the bits of the key below it only: x begins at bit 32.
  return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> 32U);
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

PointMap::PointMap(double neighbour_radius_m)
    : neighbour_radius_m_(neighbour_radius_m), table_(kFirstSlots, -1) {}

PointMap::CellIndex PointMap::index_of(const Eigen::Vector2d& p) {
  return {static_cast<std::int32_t>(std::floor(p.x() / kCellSizeM)),
          static_cast<std::int32_t>(std::floor(p.y() / kCellSizeM))};
}

std::size_t PointMap::slot_of(CellIndex index) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t slot = hash(index.x, index.y) & mask;
  while (table_[slot] >= 0 && cell_indices_[static_cast<std::size_t>(table_[slot])] != index) {
    slot = (slot + 1) & mask;
  }
  return slot;
}

const PointMap::Cell* PointMap::find_cell(CellIndex index) const {
  const std::int32_t cell = table_[slot_of(index)];
  return cell < 0 ? nullptr : &cells_[static_cast<std::size_t>(cell)];
}

PointMap::Cell& PointMap::make_cell(CellIndex index) {
  const std::int32_t found = table_[slot_of(index)];
  if (found >= 0) {
    return cells_[static_cast<std::size_t>(found)];
  }
  if (2 * (cells_.size() + 1) > table_.size()) {
    grow_table();
  }
  table_[slot_of(index)] = static_cast<std::int32_t>(cells_.size());
  cell_indices_.push_back(index);
  return cells_.emplace_back();
}

void PointMap::grow_table() {
  table_.assign(2 * table_.size(), -1);
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
    table_[slot_of(cell_indices_[cell])] = static_cast<std::int32_t>(cell);
  }
}

template <typename Visit>
void PointMap::for_each_neighbour(const SurfacePoint& point, Visit visit) const {
  const CellIndex low = index_of(point.p.array() - neighbour_radius_m_);
  const CellIndex high = index_of(point.p.array() + neighbour_radius_m_);
  for (std::int32_t y = low.y; y <= high.y; ++y) {
    for (std::int32_t x = low.x; x <= high.x; ++x) {
      const Cell* cell = find_cell({x, y});
      if (cell == nullptr) {
        continue;
      }
      for (const Entry& entry : *cell) {
        if ((point.p - entry.p).squaredNorm() <= neighbour_radius_m_ * neighbour_radius_m_ &&
            look_the_same_way(point.normal, entry.normal)) {
          visit(entry.landmark);
        }
      }
    }
  }
}

void PointMap::add(const SurfacePoint& point) {
  if (!is_finite(point)) {
    return;
  }
  const auto added = static_cast<std::uint32_t>(landmarks_.size());
  landmarks_.push_back({point, point.p, Eigen::Vector2d::Zero()});
  moments_.emplace_back().add(Eigen::Vector2d::Zero());
  for_each_neighbour(point, [&](std::uint32_t neighbour) {
    const Eigen::Vector2d d = point.p - landmarks_[neighbour].point.p;
    moments_[neighbour].add(d);
    moments_[added].add(-d);
    refit(neighbour);
  });
  refit(added);
  make_cell(index_of(point.p)).push_back({point.p, point.normal, added});
}

void PointMap::refine(const SurfacePoint& point) {
  if (!is_finite(point)) {
    return;
  }
  for_each_neighbour(point, [&](std::uint32_t neighbour) {
    moments_[neighbour].add(point.p - landmarks_[neighbour].point.p);
    refit(neighbour);
  });
}

void PointMap::refit(std::uint32_t index) {
  const Moments& m = moments_[index];
  Landmark& landmark = landmarks_[index];
  landmark.centre = landmark.point.p;
  landmark.normal = landmark.point.normal;
  if (m.n < kMinNeighbours) {
    return;
  }
  landmark.normal.setZero();
  // The line of least squares: through the mean, along the larger axis of the covariance.
  const Eigen::Vector2d mean(m.x / m.n, m.y / m.n);
  const double xx = m.xx / m.n - mean.x() * mean.x();
  const double xy = m.xy / m.n - mean.x() * mean.y();
  const double yy = m.yy / m.n - mean.y() * mean.y();
  const double middle = 0.5 * (xx + yy);
  const double half_gap = std::hypot(0.5 * (xx - yy), xy);
  if (middle - half_gap > kMaxThickness * kMaxThickness * (middle + half_gap)) {
    return;
  }
  const double along = 0.5 * std::atan2(2.0 * xy, xx - yy);
  landmark.centre += mean;
  landmark.normal = {-std::sin(along), std::cos(along)};
  if (landmark.normal.dot(landmark.point.normal) < 0.0) {
    landmark.normal = -landmark.normal;
  }
}

void PointMap::search_cell(CellIndex index, const SurfacePoint& point, Nearest& nearest) const {
  const Cell* cell = find_cell(index);
  if (cell == nullptr) {
    return;
  }
  for (const Entry& entry : *cell) {
    const double squared = (entry.p - point.p).squaredNorm();
    if (squared <= nearest.squared_m2 && look_the_same_way(point.normal, entry.normal)) {
      nearest = {squared, &entry};
    }
  }
}

const PointMap::Landmark* PointMap::nearest(const SurfacePoint& point,
                                            double max_distance_m) const {
  Nearest nearest{max_distance_m * max_distance_m, nullptr};
  // The point's own cell first: what is found there mostly makes the others needless.
  const CellIndex home = index_of(point.p);
  search_cell(home, point, nearest);
  const double reach = std::sqrt(nearest.squared_m2);
  const CellIndex low = index_of(point.p.array() - reach);
  const CellIndex high = index_of(point.p.array() + reach);
  for (std::int32_t y = low.y; y <= high.y; ++y) {
    for (std::int32_t x = low.x; x <= high.x; ++x) {
      if (const CellIndex index{x, y}; index != home) {
        search_cell(index, point, nearest);
      }
    }
  }
  return nearest.entry == nullptr ? nullptr : &landmarks_[nearest.entry->landmark];
}

}  // namespace nodmap::slam2d
