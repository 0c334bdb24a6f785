// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/explorer/left_out_places.hpp"
#include "modules/explorer/params.hpp"
#include "modules/explorer/planning_grid.hpp"
#include "modules/explorer/shortest_paths.hpp"
#include "modules/explorer/tour_planner.hpp"
#include "modules/explorer/viewpoints.hpp"
#include "modules/explorer/waypoints.hpp"

namespace nodmap::explorer {

enum class State : std::uint8_t {
  kIdle,       ///< waiting to be started
  kExploring,  ///< driving from viewpoint to viewpoint
  kReturning,  ///< everything has been seen: driving home
  kHome,       ///< everything has been seen, and the robot is back
};

/// The inputs of a decision.
struct Situation {
  time::Timestamp stamp{};
  geometry::SE2 T_map_base;
  /// False: the robot is kept from driving, wherever to, and what it does not reach has not failed.
  bool may_drive = true;
  bool has_no_path = false;  ///< the navigator finds no path to its goal
  bool has_arrived = false;  ///< the navigator is at its goal
};

struct Decision {
  State state = State::kIdle;
  std::optional<Goal> goal;
  std::string reason;                         ///< one sentence
  std::vector<Viewpoint> tour;                ///< in the order of the visits
  std::vector<Eigen::Vector2d> path_map;      ///< from the robot to the first viewpoint, or home
  std::vector<Eigen::Vector2f> frontier_map;  ///< centres of the frontier cells
  double seen_m2 = 0.0;                       ///< free ground in the map
  double waiting_m2 = 0.0;                    ///< unknown ground that the tour would show
};

/// Explores a whole building. From the frontiers of the 2D map it finds viewpoints, computes the
/// unknown area that each would show, and plans a short tour over the best of them. The robot
/// drives to the tour's first viewpoint and decides again whenever the map or its pose has changed.
/// When no viewpoint is worth the path, it returns to where it started.
class Explorer {
 public:
  explicit Explorer(const ExplorerParams& params);

  /// Adds a part of the 2D map; returns false if it is refused.
  bool add(const MapTile& tile) { return grid_.add(tile); }
  /// Forgets the map, because 2D SLAM has restarted, and home, which was a position in it.
  void forget_map() {
    grid_.clear();
    home_map_.reset();
  }

  /// Starts an exploration. Without `home_map`, home is the robot's position at the next decision.
  void start(const std::optional<Eigen::Vector2d>& home_map = std::nullopt);
  void end();
  [[nodiscard]] State state() const { return state_; }
  /// Number of places that have failed since the start.
  [[nodiscard]] std::size_t num_failures() const { return failed_places_.size(); }

  [[nodiscard]] Decision decide(const Situation& now);

 private:
  /// The viewpoint that the robot drives to.
  struct Target {
    Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
    double least_length_m = 0.0;   ///< of the path to it, when the robot last came nearer
    time::Timestamp progressed{};  ///< when that was
  };

  /// Why there is nothing to decide; empty otherwise.
  [[nodiscard]] std::string reason_to_wait() const;
  [[nodiscard]] Decision drive(const Situation& now);
  [[nodiscard]] Reach reach() const { return {grid_, paths_}; }
  /// Notes which viewpoints the robot has visited.
  void watch_visits(const Situation& now);
  /// Gives up a target to which the robot does not come nearer.
  void watch_target(const Situation& now);
  void watch_no_path(const Situation& now, bool has_paused);
  void watch_progress(const Situation& now, bool has_paused);
  void give_up_target(const Situation& now, bool has_no_path);
  /// The viewpoints that are worth a visit now; none: everything has been seen.
  [[nodiscard]] std::vector<Viewpoint> find_tour(const Situation& now);
  /// Patience begins anew only if this is another place than the present target.
  void set_target(const Viewpoint& viewpoint, const Situation& now);
  [[nodiscard]] Decision drive_tour(const Situation& now, std::vector<Viewpoint> tour);
  [[nodiscard]] Decision drive_home(const Situation& now);
  [[nodiscard]] bool is_home(const Situation& now) const;
  void begin_return();
  [[nodiscard]] std::vector<Eigen::Vector2d> path_home(const Situation& now);
  [[nodiscard]] std::string reason_at_home() const;
  [[nodiscard]] bool has_no_path_for(double seconds, const Situation& now) const;

  ExplorerParams params_;
  PlanningGrid grid_;
  ShortestPaths paths_;  // from the robot
  TourPlanner tour_planner_;
  Waypoints waypoints_;
  LeftOutPlaces failed_places_;
  LeftOutPlaces visited_places_;  // until what was seen from there is in the map

  State state_ = State::kIdle;
  std::optional<Eigen::Vector2d> home_map_;
  std::optional<Target> target_;
  time::Timestamp decided_{};
  std::optional<time::Timestamp> no_path_since_;         ///< to the viewpoint, or home
  std::vector<Eigen::Vector2d> viewpoints_on_line_map_;  ///< to the goal, which is the last
  bool heads_for_home_itself_ = false;                   ///< not for a place near it any more
};

}  // namespace nodmap::explorer
