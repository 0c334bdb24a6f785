// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/explorer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "modules/explorer/tour.hpp"

namespace nodmap::explorer {
namespace {

// Viewpoints nearer to each other than this count as the same one.
constexpr double kSameViewpointM = 0.8;
// Reduction of the path length that counts as progress.
constexpr double kProgressM = 0.2;
// After a pause without decisions of this length, the time without progress starts again.
constexpr time::Duration kPause = 2s;
// Greatest distance of a lookout from its frontier: from farther away only a slit is visible
// through a door.
constexpr double kLookoutM = 2.0;
// The same for nearest_frontier, which drives to the frontier itself.
constexpr double kAtFrontierM = 0.4;
// Places nearer to each other than this fail together, and are visited together.
constexpr double kSameFailureM = 0.7;
constexpr double kSameVisitM = 0.4;
// Cost of rotating to the start of the path, in metres of driving.
constexpr double kRotationMPerRad = 0.5;
// On the way home, a viewpoint is worth turning back for if it shows this multiple of the minimum
// gain.
constexpr double kTurnBackGainRatio = 2.0;
// Distance at which a path's direction is measured.
constexpr double kDirectionM = 0.4;
// Added to a tolerance: the navigator has arrived by a newer pose than ours.
constexpr double kArrivalM = 0.1;
constexpr const char* kNoPathHome = "Everything has been seen, but there is no path home.";

// The points of a straight line at intervals of at most `step_m`, with both ends.
std::vector<Eigen::Vector2d> straight_path(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                           double step_m) {
  const auto num_steps = static_cast<int>(std::ceil((to - from).norm() / step_m));
  std::vector<Eigen::Vector2d> points{from};
  for (int i = 1; i <= num_steps; ++i) {
    points.emplace_back(from + (to - from) * (static_cast<double>(i) / num_steps));
  }
  return points;
}

// The lengths of the paths; straight lines replace unknown paths.
std::vector<double> lengths_m(const Reach& reach, const Eigen::Vector2d& from_map,
                              const std::vector<Cell>& cells) {
  std::vector<double> lengths;
  lengths.reserve(cells.size());
  for (const Cell& cell : cells) {
    lengths.push_back(reach.paths.is_reached(cell)
                          ? reach.paths.length_m(cell)
                          : (reach.grid.center_of(cell) - from_map).norm());
  }
  return lengths;
}

}  // namespace

Explorer::Explorer(const ExplorerParams& params)
    : params_(params),
      grid_(0.5 * params.robot.body.width_m + params.side_margin_m),
      chooser_(params),
      waypoints_(params.goal_tolerance_m),
      failed_places_(params.patience.retry_s, params.patience.max_tries, kSameFailureM),
      visited_places_(params.patience.look_s, params.patience.max_tries, kSameVisitM) {}

void Explorer::start() {
  end();
  failed_places_.clear();
  visited_places_.clear();
  state_ = State::kExploring;
}

void Explorer::end() {
  state_ = State::kIdle;
  home_map_.reset();
  target_map_.reset();
  waypoints_.clear();
  passing_map_.clear();
}

Decision Explorer::decide(const Situation& now) {
  Decision decision;
  decision.reason = reason_to_wait();
  if (decision.reason.empty()) {
    decision = drive(now);
  }
  decision.state = state_;
  decision.seen_m2 =
      grid_.cell_size_m() * grid_.cell_size_m() * static_cast<double>(grid_.num_free());
  return decision;
}

std::string Explorer::reason_to_wait() const {
  switch (state_) {
    case State::kIdle:
      return "Waiting to be started.";
    case State::kHome:
      return reason_at_home();
    case State::kExploring:
    case State::kReturning:
      break;
  }
  return grid_.is_empty() ? "There is no 2D map yet." : "";
}

std::string Explorer::reason_at_home() const {
  const std::size_t num_given_up = failed_places_.num_given_up();
  if (num_given_up == 0) {
    return "Everything has been seen; the robot is back home.";
  }
  return "The robot is back home and has seen everything but what " + std::to_string(num_given_up) +
         (num_given_up == 1 ? " place" : " places") + " would show that it could not reach.";
}

Decision Explorer::drive(const Situation& now) {
  const Eigen::Vector2d p_map = now.T_map_base.translation();
  home_map_ = home_map_.value_or(p_map);
  paths_.compute(grid_, p_map);
  if (paths_.cells().empty()) {
    // Tiles of the map come one after the other, and the robot's may be missing.
    Decision decision;
    decision.reason = "The 2D map does not show free ground around the robot.";
    return decision;
  }
  watch_visits(now);
  watch_target(now);
  std::vector<Viewpoint> tour = find_tour(now);
  if (tour.empty() && failed_places_.forgive()) {
    tour = find_tour(now);
  }
  Decision decision = tour.empty() ? drive_home(now) : drive_tour(now, std::move(tour));
  for (const Cell& cell : frontiers_.cells()) {
    decision.frontier_map.emplace_back(grid_.center_of(cell).cast<float>());
  }
  return decision;
}

// Notes which viewpoints the robot has visited; what it has seen from there is not yet in the map.
void Explorer::watch_visits(const Situation& now) {
  const Eigen::Vector2d p_map = now.T_map_base.translation();
  std::erase_if(passing_map_, [&](const Eigen::Vector2d& viewpoint_map) {
    const bool is_visited = (p_map - viewpoint_map).norm() < params_.goal_tolerance_m + kArrivalM;
    if (is_visited) {
      visited_places_.add(viewpoint_map, now.stamp);
    }
    return is_visited;
  });
}

// Detects that the target has failed: the robot does not come nearer to it.
void Explorer::watch_target(const Situation& now) {
  const bool has_paused =
      std::chrono::abs(now.stamp - std::exchange(decided_, now.stamp)) > kPause || !now.may_drive;
  if (has_paused || !now.has_no_path) {
    no_path_since_.reset();
  }
  if (now.has_no_path) {
    no_path_since_ = no_path_since_.value_or(now.stamp);
  }
  if (state_ != State::kExploring || !target_map_) {
    return;
  }
  const double length_m = paths_.length_m(grid_.cell_of(*target_map_));
  if (has_paused || length_m < least_length_m_ - kProgressM) {
    least_length_m_ = std::min(least_length_m_, length_m);
    progressed_ = now.stamp;
  }
  const bool has_no_path = has_no_path_for(params_.patience.no_path_s, now);
  if (has_no_path ||
      std::chrono::abs(now.stamp - progressed_) > time::from_seconds(params_.patience.stuck_s)) {
    // The goal is the last of the viewpoints on the way, and the navigator has planned to it only.
    const bool is_behind_target = has_no_path && !passing_map_.empty();
    failed_places_.add(is_behind_target ? passing_map_.back() : *target_map_, now.stamp);
    target_map_.reset();
    waypoints_.clear();
  }
}

std::vector<Viewpoint> Explorer::find_tour(const Situation& now) {
  frontiers_.find(reach());
  const bool by_tour = params_.policy == Policy::kTour;
  std::vector<Cell> lookouts = frontiers_.lookouts(reach(), by_tour ? kLookoutM : kAtFrontierM);
  const Eigen::Vector2d p_robot_map = now.T_map_base.translation();
  std::erase_if(lookouts, [&](const Cell& cell) {
    const Eigen::Vector2d p_map = grid_.center_of(cell);
    return (p_map - p_robot_map).norm() < params_.goal_tolerance_m ||
           failed_places_.excludes(p_map, now.stamp) || visited_places_.excludes(p_map, now.stamp);
  });
  std::vector<Viewpoint> found = by_tour ? chooser_.choose(reach(), lookouts, now.T_map_base.yaw)
                                         : nearest_frontier(now, lookouts);
  const double least_m2 =
      params_.view.min_gain_m2 * (state_ == State::kReturning ? kTurnBackGainRatio : 1.0);
  std::erase_if(found, [&](const Viewpoint& v) { return v.gain_m2 < least_m2; });
  return by_tour && !found.empty() ? in_order(now, std::move(found)) : found;
}

// The nearest viewpoint. The previous one is kept until the robot is there, or until nothing is
// left to see from it.
std::vector<Viewpoint> Explorer::nearest_frontier(const Situation& now,
                                                  const std::vector<Cell>& lookouts) {
  const Eigen::Vector2d p_map = now.T_map_base.translation();
  if (target_map_ && (p_map - *target_map_).norm() > params_.goal_tolerance_m &&
      paths_.is_reached(grid_.cell_of(*target_map_))) {
    if (const auto same = chooser_.nearest(reach(), {grid_.cell_of(*target_map_)})) {
      return {*same};
    }
  }
  const auto nearest = chooser_.nearest(reach(), lookouts);
  return nearest ? std::vector<Viewpoint>{*nearest} : std::vector<Viewpoint>{};
}

// Orders the viewpoints in the best tour; it starts with the present target unless another tour is
// clearly better.
std::vector<Viewpoint> Explorer::in_order(const Situation& now, std::vector<Viewpoint> viewpoints) {
  TourProblem problem;
  const Eigen::Vector2d p_map = now.T_map_base.translation();
  problem.length_weight = params_.tour.home_weight_m2;
  std::vector<Cell> cells;
  const std::optional<std::size_t> present = present_target(viewpoints);
  for (const Viewpoint& viewpoint : viewpoints) {
    cells.push_back(viewpoint.cell);
    problem.weight.push_back(viewpoint.gain_m2);
    problem.from_start_m.push_back(viewpoint.length_m +
                                   kRotationMPerRad * rotation_rad(viewpoint, now.T_map_base));
  }
  for (const Viewpoint& viewpoint : viewpoints) {
    paths_between_.compute(grid_, viewpoint.p_map, cells);
    problem.between_m.push_back(lengths_m({grid_, paths_between_}, viewpoint.p_map, cells));
  }
  paths_between_.compute(grid_, *home_map_, cells);
  problem.to_end_m = lengths_m({grid_, paths_between_}, *home_map_, cells);
  problem.from_start_to_end_m = lengths_m(reach(), p_map, {grid_.cell_of(*home_map_)}).front();
  Tour tour = shortest_tour(problem);
  if (present && tour.order.front() != *present) {
    const Tour same = shortest_tour(problem, present);
    if (same.cost < (1.0 + params_.tour.hysteresis_ratio) * tour.cost) {
      tour = same;
    }
  }
  leave_out_detours(problem, params_.tour.min_gain_m2_per_m, params_.tour.always_gain_m2,
                    tour.order);
  std::vector<Viewpoint> ordered;
  for (const std::size_t stop : tour.order) {
    ordered.push_back(viewpoints[stop]);
  }
  return ordered;
}

// The viewpoint that is the present target.
std::optional<std::size_t> Explorer::present_target(
    const std::vector<Viewpoint>& viewpoints) const {
  if (!target_map_) {
    return std::nullopt;
  }
  const auto from_target_m = [&](const Viewpoint& viewpoint) {
    return (viewpoint.p_map - *target_map_).norm();
  };
  const auto nearest = std::ranges::min_element(viewpoints, {}, from_target_m);
  if (nearest == viewpoints.end() || from_target_m(*nearest) >= kSameViewpointM) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(nearest - viewpoints.begin());
}

// How far the robot must rotate to drive along the path to a viewpoint.
double Explorer::rotation_rad(const Viewpoint& viewpoint, const geometry::SE2& T_map_base) const {
  const std::vector<Eigen::Vector2d> path_map = path_to(viewpoint.cell);
  const auto ahead = std::ranges::find_if(path_map, [&](const Eigen::Vector2d& p) {
    return (p - T_map_base.translation()).norm() > kDirectionM;
  });
  const Eigen::Vector2d to =
      (ahead == path_map.end() ? viewpoint.p_map : *ahead) - T_map_base.translation();
  return std::abs(geometry::angle_difference(std::atan2(to.y(), to.x()), T_map_base.yaw));
}

void Explorer::set_target(const Eigen::Vector2d& p_map, double length_m, const Situation& now) {
  if (!target_map_ || (*target_map_ - p_map).norm() > kSameViewpointM) {
    least_length_m_ = length_m;
    progressed_ = now.stamp;
    no_path_since_.reset();
  } else if (const double present_m = paths_.length_m(grid_.cell_of(*target_map_));
             std::isfinite(present_m)) {
    // A frontier may recede as fast as the robot drives: what counts is the way driven.
    least_length_m_ += length_m - present_m;
  }
  target_map_ = p_map;
}

Decision Explorer::drive_tour(const Situation& now, std::vector<Viewpoint> tour) {
  Decision decision;
  state_ = State::kExploring;
  set_target(tour.front().p_map, tour.front().length_m, now);
  decision.reason = "Driving to the next viewpoint.";
  const Eigen::Vector2d p_map = now.T_map_base.translation();
  const std::size_t num_passing = num_on_line(grid_, tour, p_map, params_.goal_tolerance_m);
  passing_map_.clear();
  for (std::size_t i = 0; i < num_passing; ++i) {
    passing_map_.push_back(tour[i].p_map);
  }
  decision.path_map = num_passing == 1
                          ? path_to(tour.front().cell)
                          : straight_path(p_map, passing_map_.back(), grid_.cell_size_m());
  decision.goal = waypoints_.next(grid_, decision.path_map, p_map, params_.goal_tolerance_m);
  for (const Viewpoint& viewpoint : tour) {
    decision.waiting_m2 += viewpoint.gain_m2;
  }
  decision.tour = std::move(tour);
  return decision;
}

Decision Explorer::drive_home(const Situation& now) {
  Decision decision;
  const double distance_m = (now.T_map_base.translation() - *home_map_).norm();
  if (distance_m <= params_.home_tolerance_m ||
      (now.has_arrived && distance_m <= params_.home_tolerance_m + kArrivalM)) {
    state_ = State::kHome;
    decision.reason = reason_at_home();
    return decision;
  }
  // By then the navigator has also looked around, and planned anew.
  if (state_ == State::kReturning && has_no_path_for(params_.patience.stuck_s, now)) {
    end();
    decision.reason = kNoPathHome;
    return decision;
  }
  if (state_ != State::kReturning) {
    state_ = State::kReturning;
    no_path_since_.reset();
    is_home_cut_off_ = false;
  }
  target_map_.reset();
  passing_map_.clear();
  decision.reason = "Everything has been seen: driving home.";
  // The start position was in no beam, so its cell may still be unknown.
  const auto near_home = std::ranges::min_element(paths_.cells(), {}, [&](const Cell& cell) {
    return (grid_.center_of(cell) - *home_map_).squaredNorm();
  });
  // Where the map shows no path any farther, the navigator may know one, or that there is none.
  const Eigen::Vector2d p_map = now.T_map_base.translation();
  is_home_cut_off_ = is_home_cut_off_ || (grid_.center_of(*near_home) - p_map).norm() <
                                             params_.goal_tolerance_m + kArrivalM;
  if (!is_home_cut_off_) {
    decision.path_map = path_to(*near_home);
  }
  decision.path_map.push_back(*home_map_);
  decision.goal = waypoints_.next(grid_, decision.path_map, p_map, params_.home_tolerance_m);
  return decision;
}

bool Explorer::has_no_path_for(double seconds, const Situation& now) const {
  return no_path_since_ &&
         std::chrono::abs(now.stamp - *no_path_since_) > time::from_seconds(seconds);
}

std::vector<Eigen::Vector2d> Explorer::path_to(const Cell& cell) const {
  std::vector<Eigen::Vector2d> path_map;
  for (const Cell& on_path : paths_.path_to(cell)) {
    path_map.push_back(grid_.center_of(on_path));
  }
  return path_map;
}

}  // namespace nodmap::explorer
