// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/set_down_place.hpp"

#include <algorithm>
#include <cstddef>

#include "common/geometry/whole_steps.hpp"

namespace nodmap::navigator {
namespace {

// Farther away the laser has looked at what is beside the robot as it came.
constexpr double kAroundM = 1.0;
// Ground of which less was not seen does not count.
constexpr double kWidthM = 0.15;

// The steps to the cells of a disc.
std::vector<Eigen::Vector2i> disc(int radius) {
  std::vector<Eigen::Vector2i> steps;
  for (int dx = -radius; dx <= radius; ++dx) {
    for (int dy = -radius; dy <= radius; ++dy) {
      if (dx * dx + dy * dy <= radius * radius) {
        steps.emplace_back(dx, dy);
      }
    }
  }
  return steps;
}

}  // namespace

void SetDownPlace::begin(LocalGrid& grid, const Eigen::Vector2d& p_odom) {
  p_odom_ = p_odom;
  for (double x = -blind_m_; x <= blind_m_; x += 0.5 * grid.cell_size_m()) {
    for (double y = -blind_m_; y <= blind_m_; y += 0.5 * grid.cell_size_m()) {
      const Eigen::Vector2d offset(x, y);
      // A laser that cannot look down steeply is blind beyond the grid.
      LocalCell* cell = offset.norm() <= blind_m_ ? grid.find(p_odom + offset) : nullptr;
      if (cell != nullptr) {
        cell->is_floor = cell->is_assumed = true;
      }
    }
  }
}

// A cell counts if it lies in a disc of which nothing was seen.
std::vector<Eigen::Vector2d> SetDownPlace::never_seen_around(
    const LocalGrid& grid, const Eigen::Vector2d& p_odom_base) const {
  const double reach_m = std::min(blind_m_, kAroundM);
  if ((p_odom_base - p_odom_).norm() > kAroundM + reach_m) {
    return {};
  }
  const int radius = geometry::whole_steps(0.5 * kWidthM, grid.cell_size_m());
  const std::vector<Eigen::Vector2i> steps = disc(radius);
  const Eigen::Vector2i middle = grid.index_of(p_odom_base);
  const int reach = geometry::whole_steps(reach_m, grid.cell_size_m());
  const int size = 2 * (reach + 2 * radius) + 1;
  std::vector<bool> is_in_disc(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  const auto at = [&](const Eigen::Vector2i& step) {
    return static_cast<std::size_t>(step.y() + size / 2) * static_cast<std::size_t>(size) +
           static_cast<std::size_t>(step.x() + size / 2);
  };
  const auto is_unseen = [&](const Eigen::Vector2i& step) {
    return grid.contains(middle + step) && !grid.at(middle + step).is_floor;
  };
  for (const Eigen::Vector2i& center : disc(reach + radius)) {
    if (std::ranges::all_of(steps, [&](const auto& step) { return is_unseen(center + step); })) {
      for (const Eigen::Vector2i& step : steps) {
        is_in_disc[at(center + step)] = true;
      }
    }
  }
  std::vector<Eigen::Vector2d> points_odom;
  for (const Eigen::Vector2i& step : disc(reach)) {
    const Eigen::Vector2d p_odom = grid.center_of(middle + step);
    if (is_in_disc[at(step)] && (p_odom - p_odom_).norm() <= kAroundM) {
      points_odom.push_back(p_odom);
    }
  }
  return points_odom;
}

}  // namespace nodmap::navigator
