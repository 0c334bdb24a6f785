// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/cost_to_go.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "common/geometry/whole_steps.hpp"

namespace nodmap::navigator {
namespace {

// Costs are queued by buckets this wide, in proportion to the edge of a cell: the error of a path
// is at most a bucket for each cell. A diagonal step at the highest price is still shorter than all
// buckets together.
constexpr float kBucketM = 0.02F;
constexpr std::size_t kNumBuckets = 64;
// The plan is read within this distance, because the robot may be where no path leads through.
constexpr double kSearchRadiusM = 0.3;
constexpr float kNever = std::numeric_limits<float>::infinity();
constexpr double kUnreached = std::numeric_limits<double>::infinity();

struct Neighbour {
  int dx;
  int dy;
  float length_m;  // with cells of the usual edge
};
constexpr auto kStraightM = static_cast<float>(PlanWindow::kCellM);
constexpr float kDiagonalM = 0.0707107F;
constexpr std::array<Neighbour, 8> kNeighbours{{{1, 0, kStraightM},
                                                {-1, 0, kStraightM},
                                                {0, 1, kStraightM},
                                                {0, -1, kStraightM},
                                                {1, 1, kDiagonalM},
                                                {1, -1, kDiagonalM},
                                                {-1, 1, kDiagonalM},
                                                {-1, -1, kDiagonalM}}};

}  // namespace

double CostToGo::at(const Eigen::Vector2d& p_map) const {
  const Eigen::Vector2i cell = window_.cell_of(p_map);
  return window_.contains(cell.x(), cell.y())
             ? offset_m_ + static_cast<double>(cost_[window_.index_of(cell.x(), cell.y())])
             : std::numeric_limits<double>::infinity();
}

double CostToGo::least_near(const Eigen::Vector2d& p_map) const {
  double least = std::numeric_limits<double>::infinity();
  for (double dx = -kSearchRadiusM; dx <= kSearchRadiusM; dx += window_.cell_m) {
    for (double dy = -kSearchRadiusM; dy <= kSearchRadiusM; dy += window_.cell_m) {
      least = std::min(least, at(p_map + Eigen::Vector2d(dx, dy)) + std::hypot(dx, dy));
    }
  }
  return least;
}

std::vector<Eigen::Vector2d> CostToGo::path_from(const Eigen::Vector2d& p_map, double max_m) const {
  // From the middle of one cell to the middle of the next: on a border rounding would choose the
  // cell.
  const Eigen::Vector2d cell = ((p_map - window_.origin) / window_.cell_m).array().floor();
  std::vector<Eigen::Vector2d> path{window_.origin +
                                    window_.cell_m * (cell + Eigen::Vector2d(0.5, 0.5))};
  const auto max_points = static_cast<std::size_t>(geometry::whole_steps(max_m, window_.cell_m));
  while (path.size() < max_points) {
    Eigen::Vector2d next = path.back();
    double least = at(path.back());
    for (const Neighbour& n : kNeighbours) {
      const Eigen::Vector2d p = path.back() + window_.cell_m * Eigen::Vector2d(n.dx, n.dy);
      if (at(p) < least) {
        least = at(p);
        next = p;
      }
    }
    if (next == path.back()) {
      break;
    }
    path.push_back(next);
  }
  return path;
}

CostSearch::CostSearch() : buckets_(kNumBuckets) {}

void CostSearch::begin(const PlanWindow& window, std::span<const float> price,
                       const Eigen::Vector2d& goal_map, double tolerance_m, double outside_price) {
  begin_at_goal(window, price, goal_map, tolerance_m);
  const Eigen::Vector2i goal = window.cell_of(goal_map);
  if (!window.contains(goal.x(), goal.y())) {
    seed_border(price, [&](const Eigen::Vector2d& p_map, const Eigen::Vector2d& /*outwards*/) {
      return outside_price * (goal_map - p_map).norm();
    });
  }
}

// A path from the border back through the window is for the window's own cells to find.
void CostSearch::begin(const PlanWindow& window, std::span<const float> price,
                       const Eigen::Vector2d& goal_map, double tolerance_m,
                       const CostToGo& beyond) {
  begin_at_goal(window, price, goal_map, tolerance_m);
  seed_border(price, [&](const Eigen::Vector2d& p_map, const Eigen::Vector2d& outwards) {
    const Eigen::Vector2d aside(-outwards.y(), outwards.x());
    const double cost_m = beyond.at(p_map);
    bool leads_out = false;
    for (const Eigen::Vector2d& step :
         {outwards, Eigen::Vector2d(outwards + aside), Eigen::Vector2d(outwards - aside)}) {
      leads_out = leads_out || beyond.at(p_map + beyond.window_.cell_m * step) < cost_m;
    }
    return leads_out ? cost_m : std::numeric_limits<double>::infinity();
  });
}

// Seeds no cell if the goal is outside.
void CostSearch::begin_at_goal(const PlanWindow& window, std::span<const float> price,
                               const Eigen::Vector2d& goal_map, double tolerance_m) {
  clear(window);
  const Eigen::Vector2i goal = window.cell_of(goal_map);
  if (window.contains(goal.x(), goal.y())) {
    seed_goal(price, goal_map, tolerance_m);
  }
}

void CostSearch::clear(const PlanWindow& window) {
  found_.window_ = window;
  found_.offset_m_ = 0.0;
  found_.cost_.assign(window.num_cells(), kNever);
  for (auto& bucket : buckets_) {
    bucket.clear();
  }
  bucket_ = 0;
  num_queued_ = 0;
  seeds_.clear();
  scale_ = static_cast<float>(window.cell_m / PlanWindow::kCellM);
}

void CostSearch::begin_onward(const PlanWindow& window, std::span<const float> price,
                              const Onward& onward) {
  clear(window);
  const geometry::SE2 T_base_map = onward.T_map_base.inverse();
  for (int row = 0; row < window.height; ++row) {
    for (int column = 0; column < window.width; ++column) {
      const Eigen::Vector2d p_base = T_base_map * window.center_of(column, row);
      const double distance_m = p_base.norm();
      if (distance_m >= onward.nearest_m && distance_m <= onward.farthest_m) {
        add_seed(price, {column, row},
                 onward.short_price * (onward.farthest_m - distance_m) +
                     onward.aside_m_rad * std::abs(std::atan2(p_base.y(), p_base.x())));
      }
    }
  }
  std::ranges::sort(seeds_, std::greater());
}

void CostSearch::seed_goal(std::span<const float> price, const Eigen::Vector2d& goal_map,
                           double tolerance_m) {
  const PlanWindow& window = found_.window_;
  const double radius_m = std::max(window.cell_m, 0.7 * tolerance_m);
  const Eigen::Vector2d corner_map = goal_map - Eigen::Vector2d::Constant(radius_m);
  const Eigen::Vector2i first = window.cell_of(corner_map);
  const int steps = geometry::whole_steps(2.0 * radius_m, window.cell_m);
  // Only cells of the window, however large the tolerance.
  for (int j = std::max(0, -first.y()); j <= std::min(steps, window.height - 1 - first.y()); ++j) {
    for (int i = std::max(0, -first.x()); i <= std::min(steps, window.width - 1 - first.x()); ++i) {
      const double dx = i * window.cell_m - radius_m;
      const double dy = j * window.cell_m - radius_m;
      const std::size_t cell = window.index_of(first.x() + i, first.y() + j);
      if (dx * dx + dy * dy <= radius_m * radius_m && price[cell] >= 0.0F) {
        push(cell, static_cast<float>(std::hypot(dx, dy)));
      }
    }
  }
}

// `cost_at`: the cost to go at a cell's middle, from which one direction leads out of the window.
// With a goal inside, which costs nothing, there is no offset.
void CostSearch::seed_border(std::span<const float> price, const auto& cost_at) {
  const PlanWindow& window = found_.window_;
  std::vector<std::pair<double, Eigen::Vector2i>> border;
  const auto add = [&](int column, int row, const Eigen::Vector2d& outwards) {
    const double cost_m = cost_at(window.center_of(column, row), outwards);
    if (std::isfinite(cost_m)) {
      border.emplace_back(cost_m, Eigen::Vector2i(column, row));
    }
  };
  for (int column = 0; column < window.width; ++column) {
    add(column, 0, {0.0, -1.0});
    add(column, window.height - 1, {0.0, 1.0});
  }
  for (int row = 0; row < window.height; ++row) {
    add(0, row, {-1.0, 0.0});
    add(window.width - 1, row, {1.0, 0.0});
  }
  if (num_queued_ == 0 && !border.empty()) {
    found_.offset_m_ =
        std::ranges::min_element(border, {}, [](const auto& seed) { return seed.first; })->first;
  }
  for (const auto& [cost_m, cell] : border) {
    add_seed(price, cell, cost_m - found_.offset_m_);
  }
  std::ranges::sort(seeds_, std::greater());
}

void CostSearch::add_seed(std::span<const float> price, const Eigen::Vector2i& cell,
                          double cost_m) {
  const std::size_t place = found_.window_.index_of(cell.x(), cell.y());
  if (price[place] >= 0.0F) {
    seeds_.emplace_back(static_cast<float>(cost_m), place);
  }
}

std::size_t CostSearch::bucket_of(float cost) const {
  return static_cast<std::size_t>(cost / (scale_ * kBucketM));
}

// Seeds wait for their turn, because the buckets hold only a short range of costs.
void CostSearch::take_seeds() {
  if (num_queued_ == 0 && !seeds_.empty()) {
    bucket_ = std::max(bucket_, bucket_of(seeds_.back().first));
  }
  while (!seeds_.empty() && bucket_of(seeds_.back().first) <= bucket_) {
    const auto [cost, cell] = seeds_.back();
    seeds_.pop_back();
    if (cost < found_.cost_[cell]) {
      push(cell, cost);
    }
  }
}

void CostSearch::push(std::size_t cell, float cost) {
  found_.cost_[cell] = cost;
  buckets_[bucket_of(cost) % kNumBuckets].push_back(static_cast<std::uint32_t>(cell));
  ++num_queued_;
}

bool CostSearch::advance(std::span<const float> price, int max_cells) {
  for (int count = 0; count < max_cells;) {
    take_seeds();
    if (num_queued_ == 0) {
      if (seeds_.empty()) {
        break;
      }
      continue;  // those of this bucket were reached at a lower cost
    }
    auto& bucket = buckets_[bucket_ % kNumBuckets];
    if (bucket.empty()) {
      ++bucket_;
      continue;
    }
    const std::uint32_t cell = bucket.back();
    bucket.pop_back();
    --num_queued_;
    // It was queued again at a lower cost, and has been spread from already.
    const float cost = found_.cost_[cell];
    if (bucket_of(cost) < bucket_) {
      continue;
    }
    ++count;
    const auto width = static_cast<std::uint32_t>(found_.window_.width);
    spread_from(price, static_cast<int>(cell % width), static_cast<int>(cell / width), cost);
  }
  return num_queued_ > 0 || !seeds_.empty();
}

void CostSearch::spread_from(std::span<const float> price, int column, int row, float cost) {
  for (const Neighbour& n : kNeighbours) {
    const int x = column + n.dx;
    const int y = row + n.dy;
    if (!found_.window_.contains(x, y)) {
      continue;
    }
    const std::size_t next = found_.window_.index_of(x, y);
    if (price[next] < 0.0F) {
      continue;
    }
    const float total = cost + scale_ * n.length_m * price[next];
    if (total < found_.cost_[next] - 1e-4F) {
      push(next, total);
    }
  }
}

}  // namespace nodmap::navigator
