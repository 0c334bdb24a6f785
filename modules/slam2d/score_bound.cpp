// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/score_bound.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::slam2d {
namespace {

constexpr double kReachM = 20.0;  // points beyond, in x or in y, count as 1
constexpr int kReachCells = static_cast<int>(kReachM / ScoreBound::kCellM);
constexpr double kBoundRoundingM = 1e-6;

}  // namespace

ScoreBound::ScoreBound(const PointMap& map, const Eigen::Vector2d& middle, double max_distance_m,
                       int max_shift_cells)
    : max_shift_(max_shift_cells), width_(2 * (kReachCells + max_shift_cells)) {
  origin_ = middle.array() - kCellM * 0.5 * width_;
  scores_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(width_));
  for (const MapPoint& point : map.points()) {
    stamp(point.point.p, max_distance_m);
  }
}

// Writes into each cell the greatest score that a point in the cell can have.
void ScoreBound::stamp(const Eigen::Vector2d& point, double max_distance_m) {
  const Eigen::Vector2d at = point - origin_;
  const double last = width_ - 1.0;
  const auto cell_at = [last](double coordinate_m) {
    return static_cast<int>(std::clamp(std::floor(coordinate_m / kCellM), -1.0, last + 1.0));
  };
  const auto to_cell = [](double coordinate_m, int cell) {
    const double from_first_m = coordinate_m - kCellM * cell;
    return std::max(
        {0.0, -from_first_m - kBoundRoundingM, from_first_m - kCellM - kBoundRoundingM});
  };
  const int first_x = std::max(cell_at(at.x() - max_distance_m), 0);
  const int last_x = std::min(cell_at(at.x() + max_distance_m), width_ - 1);
  const int first_y = std::max(cell_at(at.y() - max_distance_m), 0);
  const int last_y = std::min(cell_at(at.y() + max_distance_m), width_ - 1);
  for (int y = first_y; y <= last_y; ++y) {
    const double dy_m = to_cell(at.y(), y);
    for (int x = first_x; x <= last_x; ++x) {
      const double dx_m = to_cell(at.x(), x);
      const double score = 1.0 - std::sqrt(dx_m * dx_m + dy_m * dy_m) / max_distance_m;
      std::uint8_t& known = scores_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                                    static_cast<std::size_t>(x)];
      known = std::max(known, static_cast<std::uint8_t>(std::ceil(255.0 * std::max(0.0, score))));
    }
  }
}

std::vector<std::size_t> ScoreBound::cells_of(std::span<const Eigen::Vector2d> points) const {
  std::vector<std::size_t> cells;
  cells.reserve(points.size());
  for (const Eigen::Vector2d& point : points) {
    const Eigen::Array2d cell = ((point - origin_) / kCellM).array().floor();
    const bool is_in_reach = (cell >= max_shift_).all() && (cell < width_ - max_shift_).all();
    cells.push_back(is_in_reach ? static_cast<std::size_t>(cell.y() * width_ + cell.x())
                                : scores_.size());
  }
  return cells;
}

double ScoreBound::at(std::span<const std::size_t> cells, int x, int y) const {
  const auto shift = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(y) * width_ + x);
  int sum = 0;
  for (const std::size_t cell : cells) {
    sum += cell == scores_.size() ? 255 : scores_[cell + shift];
  }
  return cells.empty() ? 0.0 : sum / (255.0 * static_cast<double>(cells.size()));
}

}  // namespace nodmap::slam2d
