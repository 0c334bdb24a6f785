// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/navigator/planner/plan_window.hpp"

namespace nodmap::navigator {

/// The cost of the best path from each place to the goal, in metres of open floor; frame map.
class CostToGo {
 public:
  /// +infinity where there is no path, and outside.
  [[nodiscard]] double at(const Eigen::Vector2d& p_map) const;
  /// The least sum, over all cells within 0.3 m of a place, of the cell's cost and the cost of
  /// getting there. The robot may be in a cell through which no path leads.
  [[nodiscard]] double least_near(const Eigen::Vector2d& p_map) const;
  /// The path from a place downhill to the goal, at most `max_m` long, with a point for each cell.
  [[nodiscard]] std::vector<Eigen::Vector2d> path_from(const Eigen::Vector2d& p_map,
                                                       double max_m) const;

 private:
  friend class CostSearch;
  PlanWindow window_;
  // Costs are stored relative to this, the least at the border if the goal is beyond it: a float
  // has steps of 12 cm at the distance of a goal 1000 km away.
  double offset_m_ = 0.0;
  std::vector<float> cost_;
};

/// Computes the cost to go from the goal outwards, in portions (Dijkstra's algorithm with buckets).
class CostSearch {
 public:
  /// The highest price for which the buckets suffice.
  static constexpr float kHighestPrice = 16.0F;

  CostSearch();

  /// Begins a new search. `price`: the cost per metre in each cell of the window, negative if the
  /// cell is blocked; give the same to advance(). All cells within 0.7 of the goal's tolerance are
  /// the goal. A goal outside the window is reached over its border; ground outside costs
  /// `outside_price` per metre.
  void begin(const PlanWindow& window, std::span<const float> price,
             const Eigen::Vector2d& goal_map, double tolerance_m, double outside_price);
  /// The same for a window that is part of a greater one, whose cells may be coarser: paths may
  /// leave it wherever `beyond`, the cost to go in the greater one, becomes less outwards.
  void begin(const PlanWindow& window, std::span<const float> price,
             const Eigen::Vector2d& goal_map, double tolerance_m, const CostToGo& beyond);

  /// Where a path without a goal may end: in any direction, between two distances from base.
  struct Onward {
    geometry::SE2 T_map_base;
    double nearest_m = 0.0;
    double farthest_m = 0.0;
    double short_price = 0.0;  ///< cost of each metre by which the end is nearer than `farthest_m`
    double aside_m_rad = 0.0;  ///< cost of each radian by which the end is off ahead
  };
  /// Begins a new search without a goal. The window must reach beyond the farthest ends.
  void begin_onward(const PlanWindow& window, std::span<const float> price, const Onward& onward);

  /// Continues for at most `max_cells` cells. Returns false when the search is complete.
  [[nodiscard]] bool advance(std::span<const float> price, int max_cells);

  /// What has been found so far.
  [[nodiscard]] const CostToGo& found() const { return found_; }
  /// Exchanges it for an old plan, whose memory the next search uses.
  void exchange_found(CostToGo& plan) { std::swap(found_, plan); }

 private:
  void clear(const PlanWindow& window);
  void begin_at_goal(const PlanWindow& window, std::span<const float> price,
                     const Eigen::Vector2d& goal_map, double tolerance_m);
  void seed_goal(std::span<const float> price, const Eigen::Vector2d& goal_map, double tolerance_m);
  void seed_border(std::span<const float> price, const auto& cost_at);
  void add_seed(std::span<const float> price, const Eigen::Vector2i& cell, double cost_m);
  void take_seeds();
  void spread_from(std::span<const float> price, int column, int row, float cost);
  void push(std::size_t cell, float cost);
  [[nodiscard]] std::size_t bucket_of(float cost) const;

  CostToGo found_;
  std::vector<std::vector<std::uint32_t>> buckets_;
  std::size_t bucket_ = 0;
  std::size_t num_queued_ = 0;
  float scale_ = 1.0F;  // edge of the window's cells, compared with the usual one
  /// Cells whose cost is known from the start, the cheapest last: at the window's border for a goal
  /// beyond it, or the ends of a search without a goal.
  std::vector<std::pair<float, std::size_t>> seeds_;  // costs without the offset
};

}  // namespace nodmap::navigator
