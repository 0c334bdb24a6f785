// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/explorer/failed_places.hpp"
#include "modules/explorer/frontiers.hpp"
#include "modules/explorer/params.hpp"
#include "modules/explorer/planning_grid.hpp"
#include "modules/explorer/shortest_paths.hpp"
#include "modules/explorer/viewpoints.hpp"

namespace nodmap::explorer {

enum class State : std::uint8_t {
  kIdle,       ///< waits to be started
  kExploring,  ///< drives from viewpoint to viewpoint
  kReturning,  ///< all is seen: drives back home
  kHome,       ///< all is seen, and the robot is back
};

/// All that a decision needs, at one moment.
struct Situation {
  time::Timestamp stamp{};
  geometry::SE2 T_map_base;
  bool has_no_path = false;  ///< the navigator finds no path to its goal
  bool has_arrived = false;  ///< the navigator is at its goal
};

/// Where the navigator is to drive; frame map.
struct Goal {
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  double tolerance_m = 0.3;
};

struct Decision {
  State state = State::kIdle;
  std::optional<Goal> goal;
  std::string reason;                         ///< one sentence
  std::vector<Viewpoint> tour;                ///< in the order in which they are to be visited
  std::vector<Eigen::Vector2d> path_map;      ///< from the robot to the first of them, or home
  std::vector<Eigen::Vector2f> frontier_map;  ///< middles of the frontier cells
  double seen_m2 = 0.0;                       ///< free ground in the map
  double waiting_m2 = 0.0;                    ///< unknown ground that the tour would show
};

/// Drives the robot to see a whole building: from the frontiers of the 2D map to viewpoints, each
/// with the unknown area that it would show, to a short tour over the best of them. The robot
/// drives to the tour's first viewpoint and decides again whenever the map or its place has
/// changed. When nothing worth a path is left it returns to where it began.
class Explorer {
 public:
  explicit Explorer(const ExplorerParams& params);

  /// A part of the 2D map; false when it is refused.
  bool add(const MapTile& tile) { return grid_.add(tile); }
  /// A new map begins.
  void forget_map() { grid_.clear(); }

  /// Home is where the robot is at the next decision.
  void start();
  void end();
  [[nodiscard]] State state() const { return state_; }
  /// Places at which it has failed, since its start.
  [[nodiscard]] std::size_t num_failures() const { return failed_places_.size(); }

  [[nodiscard]] Decision decide(const Situation& now);

 private:
  void watch_target(const Situation& now);
  [[nodiscard]] std::vector<Viewpoint> find_tour(const Situation& now);
  [[nodiscard]] std::vector<Viewpoint> nearest_frontier(const Situation& now,
                                                        const std::vector<Cell>& lookouts);
  [[nodiscard]] std::vector<Viewpoint> in_order(std::vector<Viewpoint> viewpoints);
  void set_target(const Eigen::Vector2d& p_map, double length_m, const Situation& now);
  void drive_tour(const Situation& now, std::vector<Viewpoint> tour, Decision& decision);
  void drive_home(const Situation& now, Decision& decision);
  [[nodiscard]] std::vector<Eigen::Vector2d> path_to(const Cell& cell) const;
  [[nodiscard]] Goal next_goal(const std::vector<Eigen::Vector2d>& path_map, const Situation& now,
                               double last_tolerance_m);
  [[nodiscard]] bool is_line_passable(const Eigen::Vector2d& from_map,
                                      const Eigen::Vector2d& to_map) const;

  ExplorerParams params_;
  PlanningGrid grid_;
  ShortestPaths paths_;
  ShortestPaths paths_between_;
  Frontiers frontiers_;
  ViewpointChooser chooser_;
  FailedPlaces failed_places_;

  State state_ = State::kIdle;
  std::optional<Eigen::Vector2d> home_map_;
  std::optional<Eigen::Vector2d> target_map_;  ///< the viewpoint
  double least_length_m_ = 0.0;                ///< of the path to it, at progressed_
  time::Timestamp progressed_{};
  time::Timestamp there_since_{};
  time::Timestamp decided_{};
  std::optional<Eigen::Vector2d> waypoint_map_;
};

}  // namespace nodmap::explorer
