// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/explorer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "modules/explorer/tour.hpp"

namespace nodmap::explorer {
namespace {

/// Viewpoints nearer to each other than this count as the same one.
constexpr double kSameViewpointM = 0.8;
/// Reduction of the path length that counts as progress.
constexpr double kProgressM = 0.2;
/// After a pause without decisions of this length, the time without progress starts again.
constexpr time::Duration kPause = 2s;
/// Greatest distance of a lookout from its frontier: from farther away only a slit is visible
/// through a door.
constexpr double kLookoutM = 2.0;
constexpr double kAtFrontierM = 0.4;
/// On the way home, a viewpoint must show this multiple of the minimum gain to be worth turning
/// back.
constexpr double kWorthGoingBack = 2.0;
/// A waypoint must be at least this far away to be kept, so that the robot never brakes for one.
constexpr double kNextWaypointM = 1.0;
constexpr double kSameWaypointM = 0.5;
/// Added to a waypoint's tolerance. A waypoint nearer than this is replaced before the navigator
/// has arrived there and stops.
constexpr double kReachedM = 0.2;
/// Added to the tolerance: a waypoint is at least this far away, even around a corner.
constexpr double kLeastAheadM = 0.5;
/// Cells within this distance are not checked, because the robot may already be nearer to an
/// obstacle than a path may.
constexpr double kAroundRobotM = 0.4;
/// Tolerance for the navigator's newer pose.
constexpr double kArrivalM = 0.1;
constexpr const char* kAtHome = "Everything has been seen; the robot is back home.";

/// Whether a waypoint is on the path and far enough ahead that the robot does not brake for it.
bool is_ahead(const std::vector<Eigen::Vector2d>& path_map, const Eigen::Vector2d& waypoint_map,
              const Eigen::Vector2d& p_map) {
  return (waypoint_map - p_map).norm() > kNextWaypointM &&
         std::ranges::any_of(path_map, [&](const Eigen::Vector2d& p) {
           return (p - waypoint_map).norm() < 0.5 * kSameWaypointM;
         });
}

/// The lengths of the paths; straight lines replace unknown paths.
std::vector<double> lengths_m(const PlanningGrid& grid, const ShortestPaths& paths,
                              const Eigen::Vector2d& from_map, const std::vector<Cell>& cells) {
  std::vector<double> lengths;
  for (const Cell& cell : cells) {
    lengths.push_back(paths.is_reached(cell) ? paths.length_m(cell)
                                             : (grid.center_of(cell) - from_map).norm());
  }
  return lengths;
}

}  // namespace

Explorer::Explorer(const ExplorerParams& params)
    : params_(params),
      grid_(0.5 * params.robot.body.width_m + params.side_margin_m),
      chooser_(params),
      failed_places_(params.patience) {}

void Explorer::start() {
  end();
  state_ = State::kExploring;
}

void Explorer::end() {
  state_ = State::kIdle;
  home_map_.reset();
  target_map_.reset();
  waypoint_map_.reset();
  failed_places_.clear();
}

Decision Explorer::decide(const Situation& now) {
  Decision decision;
  decision.seen_m2 =
      grid_.cell_size_m() * grid_.cell_size_m() * static_cast<double>(grid_.num_free());
  if (state_ == State::kIdle || state_ == State::kHome || grid_.is_empty()) {
    decision.state = state_;
    decision.reason = state_ == State::kIdle   ? "Waiting to be started."
                      : state_ == State::kHome ? kAtHome
                                               : "There is no 2D map yet.";
    return decision;
  }
  const Eigen::Vector2d p_map = now.T_map_base.translation();
  home_map_ = home_map_.value_or(p_map);
  paths_.compute(grid_, p_map);
  watch_target(now);
  std::vector<Viewpoint> tour = find_tour(now);
  if (tour.empty() && failed_places_.forgive()) {
    tour = find_tour(now);
  }
  if (tour.empty()) {
    drive_home(now, decision);
  } else {
    drive_tour(now, std::move(tour), decision);
  }
  for (const Cell& cell : frontiers_.cells()) {
    decision.frontier_map.emplace_back(grid_.center_of(cell).cast<float>());
  }
  decision.state = state_;
  return decision;
}

/// Detects that the target has failed: it is not reached, or nothing new is seen from it.
void Explorer::watch_target(const Situation& now) {
  const bool has_paused = std::chrono::abs(now.stamp - std::exchange(decided_, now.stamp)) > kPause;
  if (state_ != State::kExploring || !target_map_) {
    return;
  }
  const Eigen::Vector2d p_map = now.T_map_base.translation();
  const double length_m = paths_.length_m(grid_.cell_of(*target_map_));
  if (has_paused || length_m < least_length_m_ - kProgressM) {
    least_length_m_ = std::min(least_length_m_, length_m);
    progressed_ = now.stamp;
  }
  if (has_paused ||
      (!now.has_arrived && (p_map - *target_map_).norm() > params_.goal_tolerance_m)) {
    there_since_ = now.stamp;
  }
  const time::Duration patience =
      time::from_seconds(now.has_no_path ? params_.patience.no_path_s : params_.patience.stuck_s);
  if (std::chrono::abs(now.stamp - progressed_) > patience ||
      std::chrono::abs(now.stamp - there_since_) > time::from_seconds(params_.patience.look_s)) {
    failed_places_.add(*target_map_, now.stamp);
    target_map_.reset();
  }
}

std::vector<Viewpoint> Explorer::find_tour(const Situation& now) {
  frontiers_.find(grid_, paths_);
  const bool by_tour = params_.policy == Policy::kTour;
  std::vector<Cell> lookouts =
      frontiers_.lookouts(grid_, paths_, by_tour ? kLookoutM : kAtFrontierM);
  // The surroundings of the robot have been seen, unless it has just arrived.
  const Eigen::Vector2d p_robot_map = now.T_map_base.translation();
  std::erase_if(lookouts, [&](const Cell& cell) {
    const Eigen::Vector2d p_map = grid_.center_of(cell);
    const bool is_target = target_map_ && (p_map - *target_map_).norm() < params_.goal_tolerance_m;
    return ((p_map - p_robot_map).norm() < params_.goal_tolerance_m && !is_target) ||
           failed_places_.is_left_out(p_map, now.stamp);
  });
  std::vector<Viewpoint> found = by_tour
                                     ? chooser_.choose(grid_, paths_, lookouts, now.T_map_base.yaw)
                                     : nearest_frontier(now, lookouts);
  const double least_m2 =
      params_.view.min_gain_m2 * (state_ == State::kReturning ? kWorthGoingBack : 1.0);
  std::erase_if(found, [&](const Viewpoint& v) { return v.gain_m2 < least_m2; });
  return by_tour && !found.empty() ? in_order(std::move(found)) : found;
}

/// The nearest viewpoint; the previous one is kept until the robot is there or nothing is left to
/// be seen from it.
std::vector<Viewpoint> Explorer::nearest_frontier(const Situation& now,
                                                  const std::vector<Cell>& lookouts) {
  const Eigen::Vector2d p_map = now.T_map_base.translation();
  if (target_map_ && (p_map - *target_map_).norm() > params_.goal_tolerance_m &&
      paths_.is_reached(grid_.cell_of(*target_map_))) {
    if (const auto same = chooser_.nearest(grid_, paths_, {grid_.cell_of(*target_map_)})) {
      return {*same};
    }
  }
  const auto nearest = chooser_.nearest(grid_, paths_, lookouts);
  return nearest ? std::vector<Viewpoint>{*nearest} : std::vector<Viewpoint>{};
}

/// Orders the viewpoints in the best tour; it starts with the present target unless another tour is
/// clearly better.
std::vector<Viewpoint> Explorer::in_order(std::vector<Viewpoint> viewpoints) {
  TourProblem problem;
  problem.length_weight = params_.tour.home_weight_m2;
  std::vector<Cell> cells;
  std::optional<std::size_t> present;
  for (const Viewpoint& viewpoint : viewpoints) {
    if (target_map_ && !present && (viewpoint.p_map - *target_map_).norm() < kSameViewpointM) {
      present = cells.size();
    }
    cells.push_back(viewpoint.cell);
    problem.weight.push_back(viewpoint.gain_m2);
    problem.from_start.push_back(viewpoint.length_m);
  }
  for (const Viewpoint& viewpoint : viewpoints) {
    paths_between_.compute(grid_, viewpoint.p_map, cells);
    problem.between.push_back(lengths_m(grid_, paths_between_, viewpoint.p_map, cells));
  }
  paths_between_.compute(grid_, *home_map_, cells);
  problem.to_end = lengths_m(grid_, paths_between_, *home_map_, cells);
  Tour tour = shortest_tour(problem);
  if (present && tour.order.front() != *present) {
    const Tour same = shortest_tour(problem, present);
    if (same.cost < (1.0 + params_.tour.hysteresis_ratio) * tour.cost) {
      tour = same;
    }
  }
  std::vector<Viewpoint> ordered;
  for (const std::size_t stop : tour.order) {
    ordered.push_back(viewpoints[stop]);
  }
  return ordered;
}

void Explorer::set_target(const Eigen::Vector2d& p_map, double length_m, const Situation& now) {
  if (!target_map_ || (*target_map_ - p_map).norm() > kSameViewpointM) {
    least_length_m_ = length_m;
    progressed_ = now.stamp;
    there_since_ = now.stamp;
  }
  target_map_ = p_map;
}

void Explorer::drive_tour(const Situation& now, std::vector<Viewpoint> tour, Decision& decision) {
  state_ = State::kExploring;
  set_target(tour.front().p_map, tour.front().length_m, now);
  decision.reason = "Driving to the next viewpoint.";
  decision.path_map = path_to(tour.front().cell);
  decision.goal = next_goal(decision.path_map, now, params_.goal_tolerance_m);
  for (const Viewpoint& viewpoint : tour) {
    decision.waiting_m2 += viewpoint.gain_m2;
  }
  decision.tour = std::move(tour);
}

void Explorer::drive_home(const Situation& now, Decision& decision) {
  const double distance_m = (now.T_map_base.translation() - *home_map_).norm();
  if (distance_m <= params_.home_tolerance_m ||
      (now.has_arrived && distance_m <= params_.home_tolerance_m + kArrivalM)) {
    state_ = State::kHome;
    decision.reason = kAtHome;
    return;
  }
  state_ = State::kReturning;
  target_map_.reset();
  decision.reason = "Everything has been seen: driving home.";
  // The start position was in no beam, so its cell may still be unknown.
  const auto near_home = std::ranges::min_element(paths_.cells(), {}, [&](const Cell& cell) {
    return (grid_.center_of(cell) - *home_map_).squaredNorm();
  });
  if (near_home != paths_.cells().end()) {
    decision.path_map = path_to(*near_home);
  }
  decision.path_map.push_back(*home_map_);
  decision.goal = next_goal(decision.path_map, now, params_.home_tolerance_m);
}

std::vector<Eigen::Vector2d> Explorer::path_to(const Cell& cell) const {
  std::vector<Eigen::Vector2d> path_map;
  for (const Cell& on_path : paths_.path_to(cell)) {
    path_map.push_back(grid_.center_of(on_path));
  }
  return path_map;
}

/// The farthest point of the path to which a straight line is free, but at least some distance
/// ahead. The navigator knows only the surroundings of its path; when it is led around corners it
/// need not guess what is behind walls.
Goal Explorer::next_goal(const std::vector<Eigen::Vector2d>& path_map, const Situation& now,
                         double last_tolerance_m) {
  const Eigen::Vector2d p_map = now.T_map_base.translation();
  const Eigen::Vector2d& last = path_map.back();
  const auto farthest = std::find_if(path_map.rbegin(), path_map.rend(), [&](const auto& p) {
    return is_line_passable(p_map, p) ||
           (p - p_map).norm() < params_.goal_tolerance_m + kLeastAheadM;
  });
  if (farthest == path_map.rbegin() || farthest == path_map.rend()) {
    waypoint_map_.reset();
    return {last, last_tolerance_m};
  }
  const bool is_kept = waypoint_map_ &&
                       (*waypoint_map_ - p_map).norm() > params_.goal_tolerance_m + kReachedM &&
                       ((*waypoint_map_ - *farthest).norm() < kSameWaypointM ||
                        is_ahead(path_map, *waypoint_map_, p_map));
  if (!is_kept) {
    waypoint_map_ = *farthest;
  }
  return {*waypoint_map_, params_.goal_tolerance_m};
}

/// Checks the line at intervals of one planning cell, except near the robot.
bool Explorer::is_line_passable(const Eigen::Vector2d& from_map,
                                const Eigen::Vector2d& to_map) const {
  const double length_m = (to_map - from_map).norm();
  const int num_steps = static_cast<int>(length_m / grid_.cell_size_m());
  for (int i = 1; i <= num_steps; ++i) {
    const double ratio = i * grid_.cell_size_m() / length_m;
    const Eigen::Vector2d p_map = from_map + ratio * (to_map - from_map);
    if (ratio * length_m > kAroundRobotM && !grid_.is_passable(grid_.cell_of(p_map))) {
      return false;
    }
  }
  return true;
}

}  // namespace nodmap::explorer
