// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "common/robot/footprint.hpp"
#include "modules/navigator/geofence.hpp"
#include "modules/navigator/local_map/local_map.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/planner/distance_field.hpp"

namespace nodmap::navigator {

/// The cost of the best path from each place to the goal, in metres of open floor; frame map.
class CostToGo {
 public:
  /// +infinity where there is no path, and outside.
  [[nodiscard]] double at(const Eigen::Vector2d& p_map) const;
  /// The least cost within 0.3 m of a place, and the way there: the robot may stand where no path
  /// leads through.
  [[nodiscard]] double least_near(const Eigen::Vector2d& p_map) const;
  /// Downhill from a place to the goal, at most `max_m` long, a point for each cell.
  [[nodiscard]] std::vector<Eigen::Vector2d> path_from(const Eigen::Vector2d& p_map,
                                                       double max_m) const;

 private:
  friend class GlobalPlanner;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  double cell_size_m_ = 0.05;
  int width_ = 0;
  int height_ = 0;
  std::vector<float> cost_;
};

/// Plans to the goal on all that the local map has shown: a grid in map, 51 m x 51 m of 5 cm cells,
/// around the robot. Unknown ground can be crossed at a price. Costs are found from the goal
/// outwards (Dijkstra with buckets), in small portions, so that no decision waits for them.
///
/// The robot's centre keeps half its width off what blocks; with less than the least clearance a
/// cell costs much more, and with little more still a little. Where it cannot turn, or a place is
/// narrower than the grid can tell, the local planner finds out: a narrow place in which the robot
/// could not go on is closed.
class GlobalPlanner {
 public:
  GlobalPlanner(const robot::Footprint& body, const PlannerParams& params);

  /// One portion of work. Starts anew every `replan_s`. No path crosses the boundary of
  /// `geofence`; null: none.
  void step(time::Timestamp stamp, const LocalMap& local_map, const geometry::SE2& T_map_odom,
            const geometry::SE2& T_odom_base, const Eigen::Vector2d& goal_map, double tolerance_m,
            const Geofence* geofence = nullptr);

  /// Null before the first plan to this goal is complete.
  [[nodiscard]] const CostToGo* cost_to_go() const { return complete_ ? &*complete_ : nullptr; }

  /// A place where the robot could not go on: paths through it cost more from now on.
  void add_failure(const Eigen::Vector2d& p_map);

  /// Plans anew from what the local map holds.
  void forget_ground();

  void reset();

 private:
  enum class Phase : std::uint8_t { kIdle, kMeasureDistances, kSpread };
  enum class Ground : std::uint8_t { kUnknown, kFloor, kBlocked };
  struct Failure {
    Eigen::Vector2d p_map;
    double price = 0.0;
  };

  void update_grid(const LocalMap& local_map, const geometry::SE2& T_map_odom,
                   const geometry::SE2& T_odom_base);
  void begin_window(const Eigen::Vector2d& p_map, const Eigen::Vector2d& goal_map);
  void measure_obstacle_distances(const Geofence* geofence);
  void occupy_boundary(const Geofence& geofence);
  void finish(const Eigen::Vector2d& p_map);
  void price_cells();
  void price_failures();
  void seed(const Eigen::Vector2d& goal_map, double tolerance_m);
  void seed_border(const Eigen::Vector2d& goal_map);
  void take_border_seeds();
  /// False when all is done.
  [[nodiscard]] bool spread(int max_cells);
  void spread_from(int column, int row, float cost);
  void push(std::size_t cell, float cost);
  [[nodiscard]] std::size_t place(int column, int row) const;

  robot::Footprint body_;
  PlannerParams params_;
  RollingGrid<Ground> grid_;
  Eigen::Vector2d known_min_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d known_max_ = Eigen::Vector2d::Zero();
  bool is_empty_ = true;
  std::vector<Failure> failures_;

  Phase phase_ = Phase::kIdle;
  bool is_last_resort_ = false;  // only occupied cells block, for there is no other path
  std::optional<time::Timestamp> started_at_;
  Eigen::Vector2d goal_map_ = Eigen::Vector2d::Zero();
  double tolerance_m_ = 0.0;
  DistanceField obstacle_distances_;  // of the robot's centre
  std::vector<float> price_;          // of a metre, by cell; negative: blocked
  CostToGo plan_;
  std::vector<std::vector<std::uint32_t>> buckets_;
  std::size_t bucket_ = 0;
  std::size_t num_queued_ = 0;
  /// Cells at the grid's border with their cost to a goal beyond it, the cheapest last.
  std::vector<std::pair<float, std::size_t>> border_seeds_;
  std::optional<CostToGo> complete_;
};

}  // namespace nodmap::navigator
