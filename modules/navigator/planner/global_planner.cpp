// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/global_planner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace nodmap::navigator {
namespace {

constexpr double kCellM = 0.05;
constexpr int kLog2Size = 10;
/// What the local map knows within this distance of the robot is taken over.
constexpr double kTakeOverM = 5.5;
/// Nearer to the robot it also knows what the body has driven over, or has touched.
constexpr double kBesideM = 0.6;
/// Around robot, goal and all that is known, for detours over unknown ground.
constexpr double kAroundM = 3.0;
/// Costs are queued by buckets this wide: the error of a path is at most a bucket for each cell.
constexpr float kBucketM = 0.02F;
constexpr std::size_t kNumBuckets = 64;
/// A diagonal step at this price is still shorter than all buckets together.
constexpr float kHighestPrice = 16.0F;
/// Cells of a portion: some 0.5 ms.
constexpr int kPortion = 8000;
/// Around a place where the robot could not go on.
constexpr double kFailureM = 0.3;
/// What a metre costs more where the grid leaves less than the least clearance. Occupied cells are
/// up to 3.5 cm fatter than what is in them, mixed pixels and noise add to both sides of a door: a
/// place that looks too narrow is gone to and looked at when there is no other path. The rollouts
/// measure what is really free.
constexpr double kTightPrice = 4.0;
/// The last resort keeps this off the middle of an occupied cell: enough not to slip through a wall
/// whose cells touch at their corners only, or miss one or two.
constexpr double kOccupiedM = 0.1;
/// The robot may be where no path leads through: the plan is asked so far around.
constexpr double kNearM = 0.3;
constexpr float kNever = std::numeric_limits<float>::infinity();

struct Neighbour {
  int dx;
  int dy;
  float length_m;
};
constexpr float kDiagonalM = 0.0707107F;
constexpr std::array<Neighbour, 8> kNeighbours{{{1, 0, 0.05F},
                                                {-1, 0, 0.05F},
                                                {0, 1, 0.05F},
                                                {0, -1, 0.05F},
                                                {1, 1, kDiagonalM},
                                                {1, -1, kDiagonalM},
                                                {-1, 1, kDiagonalM},
                                                {-1, -1, kDiagonalM}}};

}  // namespace

double CostToGo::at(const Eigen::Vector2d& p_map) const {
  const Eigen::Vector2d offset = (p_map - origin_) / cell_size_m_;
  const auto column = static_cast<int>(std::floor(offset.x()));
  const auto row = static_cast<int>(std::floor(offset.y()));
  if (column < 0 || row < 0 || column >= width_ || row >= height_) {
    return std::numeric_limits<double>::infinity();
  }
  return static_cast<double>(cost_[static_cast<std::size_t>(row * width_ + column)]);
}

double CostToGo::least_near(const Eigen::Vector2d& p_map) const {
  double least = std::numeric_limits<double>::infinity();
  for (double dx = -kNearM; dx <= kNearM; dx += cell_size_m_) {
    for (double dy = -kNearM; dy <= kNearM; dy += cell_size_m_) {
      least = std::min(least, at(p_map + Eigen::Vector2d(dx, dy)) + std::hypot(dx, dy));
    }
  }
  return least;
}

std::vector<Eigen::Vector2d> CostToGo::path_from(const Eigen::Vector2d& p_map, double max_m) const {
  // From the middle of a cell to that of the next: on a border rounding would decide which it is.
  const Eigen::Vector2d cell = ((p_map - origin_) / cell_size_m_).array().floor();
  std::vector<Eigen::Vector2d> path{origin_ + cell_size_m_ * (cell + Eigen::Vector2d(0.5, 0.5))};
  const auto max_points = static_cast<std::size_t>(max_m / cell_size_m_);
  while (path.size() < max_points) {
    Eigen::Vector2d next = path.back();
    double least = at(path.back());
    for (const Neighbour& n : kNeighbours) {
      const Eigen::Vector2d p = path.back() + cell_size_m_ * Eigen::Vector2d(n.dx, n.dy);
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

GlobalPlanner::GlobalPlanner(const robot::Footprint& body, const PlannerParams& params)
    : body_(body), params_(params), grid_(kCellM, kLog2Size), buckets_(kNumBuckets) {}

void GlobalPlanner::reset() {
  *this = GlobalPlanner(body_, params_);
}

std::size_t GlobalPlanner::place(int column, int row) const {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(plan_.width_) +
         static_cast<std::size_t>(column);
}

void GlobalPlanner::add_failure(const Eigen::Vector2d& p_map) {
  failures_.push_back({p_map, params_.failure_price});
}

void GlobalPlanner::forget_ground() {
  grid_.center_on({1e6, 1e6});  // far away: every cell begins anew
  is_empty_ = true;
  started_at_.reset();
  phase_ = Phase::kIdle;
}

void GlobalPlanner::step(time::Timestamp stamp, const LocalMap& local_map,
                         const geometry::SE2& T_map_odom, const geometry::SE2& T_odom_base,
                         const Eigen::Vector2d& goal_map, double tolerance_m,
                         const Geofence* geofence) {
  const Eigen::Vector2d p_map = T_map_odom * T_odom_base.translation();
  if ((goal_map - goal_map_).norm() > 0.5 * tolerance_m || tolerance_m != tolerance_m_) {
    complete_.reset();
    failures_.clear();
    phase_ = Phase::kIdle;
    started_at_.reset();
    goal_map_ = goal_map;
    tolerance_m_ = tolerance_m;
  }
  switch (phase_) {
    case Phase::kIdle:
      if (started_at_ && time::seconds(std::chrono::abs(stamp - *started_at_)) < params_.replan_s) {
        return;
      }
      started_at_ = stamp;
      update_grid(local_map, T_map_odom, T_odom_base);
      begin_window(p_map, goal_map_);
      is_last_resort_ = false;
      phase_ = Phase::kMeasureDistances;
      return;
    case Phase::kMeasureDistances:
      measure_obstacle_distances(geofence);
      price_cells();
      seed(goal_map_, tolerance_m_);
      phase_ = Phase::kSpread;
      return;
    case Phase::kSpread:
      if (!spread(kPortion)) {
        finish(p_map);
      }
  }
}

/// Without a path the plan is made once more, over all that is not next to something occupied.
void GlobalPlanner::finish(const Eigen::Vector2d& p_map) {
  if (!is_last_resort_ && !std::isfinite(plan_.least_near(p_map))) {
    is_last_resort_ = true;
    price_cells();
    seed(goal_map_, tolerance_m_);
    return;
  }
  complete_ = plan_;
  phase_ = Phase::kIdle;
}

/// Each cell from the four of the local map whose middles lie in it. What that does not know stays
/// as it was; so does what it knows no better than before: what is behind the laser, for it keeps
/// that where odometry has drifted since, and obstacles that it has forgotten for that reason.
void GlobalPlanner::update_grid(const LocalMap& local_map, const geometry::SE2& T_map_odom,
                                const geometry::SE2& T_odom_base) {
  const Eigen::Vector2d p_map = T_map_odom * T_odom_base.translation();
  grid_.center_on(p_map);
  if (is_empty_) {
    known_min_ = known_max_ = p_map;
    is_empty_ = false;
  }
  const geometry::SE2 T_odom_map = T_map_odom.inverse();
  const geometry::SE2 T_base_map = (T_map_odom * T_odom_base).inverse();
  const Eigen::Matrix2d R_odom_map = T_odom_map.rotation();
  const Eigen::Vector2d t_odom_map = T_odom_map.translation();
  const int reach = static_cast<int>(kTakeOverM / kCellM);
  const Eigen::Vector2i middle = grid_.index_of(p_map);
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const Eigen::Vector2i index = middle + Eigen::Vector2i(dx, dy);
      if (dx * dx + dy * dy > reach * reach || !grid_.contains(index)) {
        continue;
      }
      const Eigen::Vector2d p_base = T_base_map * grid_.center_of(index);
      if (grid_.at(index) != Ground::kUnknown && p_base.x() < 0.0 && p_base.norm() > kBesideM) {
        continue;
      }
      bool is_floor = false;
      bool is_blocked = false;
      bool is_cleared = false;
      bool is_forgotten = false;
      for (const double x : {-0.25, 0.25}) {
        for (const double y : {-0.25, 0.25}) {
          const Eigen::Vector2d q_map = grid_.center_of(index) + kCellM * Eigen::Vector2d(x, y);
          const Eigen::Vector2d q_odom = R_odom_map * q_map + t_odom_map;
          const LocalCell* cell = local_map.cell_at(q_odom);
          is_blocked = is_blocked || (cell != nullptr && local_map.is_blocked_at(q_odom));
          is_forgotten = is_forgotten ||
                         (cell != nullptr && cell->is_obstacle() && !local_map.is_blocked(*cell));
          is_floor = is_floor || (cell != nullptr && cell->is_floor);
          is_cleared = is_cleared || (cell != nullptr && cell->is_cleared());
        }
      }
      if (is_blocked || (is_floor && !is_forgotten)) {
        const Eigen::Vector2d q_map = grid_.center_of(index);
        known_min_ = known_min_.cwiseMin(q_map);
        known_max_ = known_max_.cwiseMax(q_map);
        grid_.at(index) = is_blocked ? Ground::kBlocked : Ground::kFloor;
      } else if (is_cleared && grid_.at(index) == Ground::kBlocked) {
        // A level laser sees no floor, but it does see through where something was.
        grid_.at(index) = Ground::kUnknown;
      }
    }
  }
}

void GlobalPlanner::begin_window(const Eigen::Vector2d& p_map, const Eigen::Vector2d& goal_map) {
  const auto around = static_cast<int>(kAroundM / kCellM);
  const Eigen::Vector2i margin = Eigen::Vector2i::Constant(around);
  const Eigen::Vector2i last = grid_.first() + Eigen::Vector2i::Constant(grid_.size() - 1);
  const Eigen::Vector2i low =
      (grid_.index_of(known_min_.cwiseMin(p_map).cwiseMin(goal_map)) - margin)
          .cwiseMax(grid_.first());
  const Eigen::Vector2i high =
      (grid_.index_of(known_max_.cwiseMax(p_map).cwiseMax(goal_map)) + margin).cwiseMin(last);
  plan_.origin_ = kCellM * low.cast<double>();
  plan_.cell_size_m_ = kCellM;
  plan_.width_ = std::max(1, high.x() - low.x() + 1);
  plan_.height_ = std::max(1, high.y() - low.y() + 1);
}

void GlobalPlanner::measure_obstacle_distances(const Geofence* geofence) {
  const Eigen::Vector2i low = grid_.index_of(plan_.origin_ + Eigen::Vector2d(0.01, 0.01));
  obstacle_distances_.begin(plan_.origin_, kCellM, plan_.width_, plan_.height_);
  for (int row = 0; row < plan_.height_; ++row) {
    for (int column = 0; column < plan_.width_; ++column) {
      if (grid_.at(low + Eigen::Vector2i(column, row)) == Ground::kBlocked) {
        obstacle_distances_.occupy(column, row);
      }
    }
  }
  if (geofence != nullptr) {
    occupy_boundary(*geofence);
  }
  obstacle_distances_.compute();
}

void GlobalPlanner::occupy_boundary(const Geofence& geofence) {
  const Eigen::Vector2d half_size =
      0.5 * kCellM * Eigen::Vector2i(plan_.width_, plan_.height_).cast<double>();
  const Eigen::Vector2d middle_map = plan_.origin_ + half_size;
  for (const auto& p_map : geofence.boundary_near(middle_map, half_size.norm())) {
    const Eigen::Vector2d offset = (p_map - plan_.origin_) / kCellM;
    const auto column = static_cast<int>(std::floor(offset.x()));
    const auto row = static_cast<int>(std::floor(offset.y()));
    if (column >= 0 && row >= 0 && column < plan_.width_ && row < plan_.height_) {
      obstacle_distances_.occupy(column, row);
    }
  }
}

void GlobalPlanner::price_cells() {
  const Eigen::Vector2i low = grid_.index_of(plan_.origin_ + Eigen::Vector2d(0.01, 0.01));
  const double least_m = body_.half_width_m + params_.least_clearance_m;
  price_.resize(static_cast<std::size_t>(plan_.width_) * static_cast<std::size_t>(plan_.height_));
  for (int row = 0; row < plan_.height_; ++row) {
    for (int column = 0; column < plan_.width_; ++column) {
      const double distance_m = obstacle_distances_.at(column, row);
      const double nearness = std::max(0.0, 1.0 - (distance_m - least_m) / params_.wide_m);
      const bool is_unknown = grid_.at(low + Eigen::Vector2i(column, row)) == Ground::kUnknown;
      price_[place(column, row)] =
          distance_m < (is_last_resort_ ? kOccupiedM : body_.half_width_m)
              ? -1.0F
              : static_cast<float>(1.0 + params_.nearness_price * nearness * nearness +
                                   (distance_m < least_m ? kTightPrice : 0.0) +
                                   (is_unknown ? params_.unknown_price : 0.0));
    }
  }
  price_failures();
}

/// Where the robot could not go on a metre costs more. A place that looked too narrow, too, is
/// closed.
void GlobalPlanner::price_failures() {
  const double least_m = body_.half_width_m + params_.least_clearance_m;
  const int reach = static_cast<int>(kFailureM / kCellM);
  for (const Failure& failure : failures_) {
    const Eigen::Vector2d offset = (failure.p_map - plan_.origin_) / kCellM;
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const int column = static_cast<int>(offset.x()) + dx;
        const int row = static_cast<int>(offset.y()) + dy;
        const bool is_inside =
            column >= 0 && row >= 0 && column < plan_.width_ && row < plan_.height_;
        if (is_inside && dx * dx + dy * dy <= reach * reach && price_[place(column, row)] > 0.0F) {
          float& price = price_[place(column, row)];
          price = obstacle_distances_.at(column, row) < least_m
                      ? -1.0F
                      : std::min(kHighestPrice, price + static_cast<float>(failure.price));
        }
      }
    }
  }
}

/// All cells within the goal's tolerance are the goal; the robot need not stand in its middle.
void GlobalPlanner::seed(const Eigen::Vector2d& goal_map, double tolerance_m) {
  plan_.cost_.assign(price_.size(), kNever);
  for (auto& bucket : buckets_) {
    bucket.clear();
  }
  bucket_ = 0;
  num_queued_ = 0;
  border_seeds_.clear();
  const Eigen::Vector2d size = kCellM * Eigen::Vector2d(static_cast<double>(plan_.width_),
                                                        static_cast<double>(plan_.height_));
  const Eigen::Array2d from_corner = (goal_map - plan_.origin_).array();
  if ((from_corner < 0.0).any() || (from_corner >= size.array()).any()) {
    seed_border(goal_map);
    return;
  }
  const double radius_m = std::max(kCellM, 0.7 * tolerance_m);
  for (double dy = -radius_m; dy <= radius_m; dy += kCellM) {
    for (double dx = -radius_m; dx <= radius_m; dx += kCellM) {
      const Eigen::Vector2d offset = (goal_map + Eigen::Vector2d(dx, dy) - plan_.origin_) / kCellM;
      const auto column = static_cast<int>(std::floor(offset.x()));
      const auto row = static_cast<int>(std::floor(offset.y()));
      if (dx * dx + dy * dy > radius_m * radius_m || column < 0 || row < 0 ||
          column >= plan_.width_ || row >= plan_.height_ || price_[place(column, row)] < 0.0F) {
        continue;
      }
      push(place(column, row), static_cast<float>(std::hypot(dx, dy)));
    }
  }
}

/// A goal beyond the grid is reached over its border; what lies outside is unknown.
void GlobalPlanner::seed_border(const Eigen::Vector2d& goal_map) {
  const auto add = [&](int column, int row) {
    if (price_[place(column, row)] >= 0.0F) {
      const Eigen::Vector2d p_map =
          plan_.origin_ + kCellM * Eigen::Vector2d(column + 0.5, row + 0.5);
      const double cost = (1.0 + params_.unknown_price) * (goal_map - p_map).norm();
      border_seeds_.emplace_back(static_cast<float>(cost), place(column, row));
    }
  };
  for (int column = 0; column < plan_.width_; ++column) {
    add(column, 0);
    add(column, plan_.height_ - 1);
  }
  for (int row = 1; row < plan_.height_ - 1; ++row) {
    add(0, row);
    add(plan_.width_ - 1, row);
  }
  std::ranges::sort(border_seeds_, std::greater());  // the cheapest is taken from the end
}

/// The buckets hold a short range of costs, so seeds wait until it is their turn.
void GlobalPlanner::take_border_seeds() {
  const auto bucket_of = [](float cost) { return static_cast<std::size_t>(cost / kBucketM); };
  if (num_queued_ == 0 && !border_seeds_.empty()) {
    bucket_ = std::max(bucket_, bucket_of(border_seeds_.back().first));
  }
  while (!border_seeds_.empty() && bucket_of(border_seeds_.back().first) <= bucket_) {
    const auto [cost, cell] = border_seeds_.back();
    border_seeds_.pop_back();
    if (cost < plan_.cost_[cell]) {
      push(cell, cost);
    }
  }
}

void GlobalPlanner::push(std::size_t cell, float cost) {
  plan_.cost_[cell] = cost;
  buckets_[static_cast<std::size_t>(cost / kBucketM) % kNumBuckets].push_back(
      static_cast<std::uint32_t>(cell));
  ++num_queued_;
}

bool GlobalPlanner::spread(int max_cells) {
  for (int count = 0; count < max_cells;) {
    take_border_seeds();
    if (num_queued_ == 0) {
      break;
    }
    auto& bucket = buckets_[bucket_ % kNumBuckets];
    if (bucket.empty()) {
      ++bucket_;
      continue;
    }
    const std::uint32_t cell = bucket.back();
    bucket.pop_back();
    --num_queued_;
    // Queued again since, at a lower cost: then it has been spread from already.
    const float cost = plan_.cost_[cell];
    if (static_cast<std::size_t>(cost / kBucketM) < bucket_) {
      continue;
    }
    ++count;
    const auto width = static_cast<std::uint32_t>(plan_.width_);
    spread_from(static_cast<int>(cell % width), static_cast<int>(cell / width), cost);
  }
  return num_queued_ > 0 || !border_seeds_.empty();
}

void GlobalPlanner::spread_from(int column, int row, float cost) {
  for (const Neighbour& n : kNeighbours) {
    const int x = column + n.dx;
    const int y = row + n.dy;
    if (x < 0 || y < 0 || x >= plan_.width_ || y >= plan_.height_) {
      continue;
    }
    const std::size_t next = place(x, y);
    const float price = price_[next];
    if (price < 0.0F) {
      continue;
    }
    const float total = cost + n.length_m * price;
    if (total < plan_.cost_[next] - 1e-4F) {
      push(next, total);
    }
  }
}

}  // namespace nodmap::navigator
