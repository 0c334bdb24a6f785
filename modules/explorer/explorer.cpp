// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/explorer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nodmap::explorer {
namespace {

// Reduction of the path length that counts as progress.
constexpr double kProgressM = 0.2;
// After a pause without decisions of this length, the time without progress starts again.
constexpr time::Duration kPause = 2s;
// Places nearer to each other than this fail together, and are visited together.
constexpr double kSameFailureM = 0.7;
constexpr double kSameVisitM = 0.4;
// On the way home, a viewpoint is worth turning back for if it shows this multiple of the minimum
// gain.
constexpr double kTurnBackGainRatio = 2.0;
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

}  // namespace

Explorer::Explorer(const ExplorerParams& params)
    : params_(params),
      grid_(0.5 * params.robot.body.width_m + params.side_margin_m),
      tour_planner_(params),
      waypoints_(params.goal_tolerance_m),
      failed_places_(params.patience.retry_s, params.patience.max_tries, kSameFailureM),
      visited_places_(params.patience.look_s, params.patience.max_tries, kSameVisitM) {}

void Explorer::start(const std::optional<Eigen::Vector2d>& home_map) {
  end();
  home_map_ = home_map;
  failed_places_.clear();
  visited_places_.clear();
  state_ = State::kExploring;
}

void Explorer::end() {
  state_ = State::kIdle;
  home_map_.reset();
  target_.reset();
  waypoints_.clear();
  viewpoints_on_line_map_.clear();
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
  if (tour.empty() && failed_places_.permit_retries()) {
    tour = find_tour(now);
  }
  Decision decision = tour.empty() ? drive_home(now) : drive_tour(now, std::move(tour));
  for (const Cell& cell : tour_planner_.frontier_cells()) {
    decision.frontier_map.emplace_back(grid_.center_of(cell).cast<float>());
  }
  return decision;
}

// What the robot has seen from there is not yet in the map.
void Explorer::watch_visits(const Situation& now) {
  const Eigen::Vector2d p_map = now.T_map_base.translation();
  std::erase_if(viewpoints_on_line_map_, [&](const Eigen::Vector2d& viewpoint_map) {
    const bool is_visited = (p_map - viewpoint_map).norm() < params_.goal_tolerance_m + kArrivalM;
    if (is_visited) {
      visited_places_.add(viewpoint_map, now.stamp);
    }
    return is_visited;
  });
}

void Explorer::watch_target(const Situation& now) {
  const bool has_paused =
      std::chrono::abs(now.stamp - std::exchange(decided_, now.stamp)) > kPause || !now.may_drive;
  watch_no_path(now, has_paused);
  if (state_ != State::kExploring || !target_) {
    return;
  }
  watch_progress(now, has_paused);
  const bool has_no_path = has_no_path_for(params_.patience.no_path_s, now);
  const bool is_stuck = std::chrono::abs(now.stamp - target_->progressed) >
                        time::from_seconds(params_.patience.stuck_s);
  if (has_no_path || is_stuck) {
    give_up_target(now, has_no_path);
  }
}

void Explorer::watch_no_path(const Situation& now, bool has_paused) {
  if (has_paused || !now.has_no_path) {
    no_path_since_.reset();
  }
  if (now.has_no_path) {
    no_path_since_ = no_path_since_.value_or(now.stamp);
  }
}

void Explorer::watch_progress(const Situation& now, bool has_paused) {
  const double length_m = paths_.length_m(grid_.cell_of(target_->p_map));
  if (has_paused || length_m < target_->least_length_m - kProgressM) {
    target_->least_length_m = std::min(target_->least_length_m, length_m);
    target_->progressed = now.stamp;
  }
}

// The goal is the last of the viewpoints on the line, and the navigator has planned to it only.
void Explorer::give_up_target(const Situation& now, bool has_no_path) {
  const bool has_last_failed = has_no_path && !viewpoints_on_line_map_.empty();
  failed_places_.add(has_last_failed ? viewpoints_on_line_map_.back() : target_->p_map, now.stamp);
  target_.reset();
  waypoints_.clear();
}

std::vector<Viewpoint> Explorer::find_tour(const Situation& now) {
  const double turn_back = state_ == State::kReturning ? kTurnBackGainRatio : 1.0;
  const auto is_left_out = [&](const Eigen::Vector2d& p_map) {
    return failed_places_.excludes(p_map, now.stamp) || visited_places_.excludes(p_map, now.stamp);
  };
  return tour_planner_.plan(reach(),
                            {.T_map_base = now.T_map_base,
                             .home_map = *home_map_,
                             .target_map = target_ ? std::optional(target_->p_map) : std::nullopt,
                             .min_gain_m2 = params_.view.min_gain_m2 * turn_back,
                             .is_left_out = is_left_out});
}

void Explorer::set_target(const Viewpoint& viewpoint, const Situation& now) {
  if (!target_ || (target_->p_map - viewpoint.p_map).norm() > kSameViewpointM) {
    target_ = Target{.least_length_m = viewpoint.length_m, .progressed = now.stamp};
    no_path_since_.reset();
  } else if (const double present_m = paths_.length_m(grid_.cell_of(target_->p_map));
             std::isfinite(present_m)) {
    // A frontier may recede as fast as the robot drives: what counts is the way driven.
    target_->least_length_m += viewpoint.length_m - present_m;
  }
  target_->p_map = viewpoint.p_map;
}

Decision Explorer::drive_tour(const Situation& now, std::vector<Viewpoint> tour) {
  Decision decision;
  state_ = State::kExploring;
  set_target(tour.front(), now);
  decision.reason = "Driving to the next viewpoint.";
  const Eigen::Vector2d p_map = now.T_map_base.translation();
  const std::size_t num_on_the_line = num_on_line(grid_, tour, p_map, params_.goal_tolerance_m);
  viewpoints_on_line_map_.clear();
  for (std::size_t i = 0; i < num_on_the_line; ++i) {
    viewpoints_on_line_map_.push_back(tour[i].p_map);
  }
  decision.path_map = num_on_the_line == 1 ? reach().path_to(tour.front().cell)
                                           : straight_path(p_map, viewpoints_on_line_map_.back(),
                                                           grid_.cell_size_m());
  decision.goal = waypoints_.next(grid_, decision.path_map, p_map, params_.goal_tolerance_m);
  for (const Viewpoint& viewpoint : tour) {
    decision.waiting_m2 += viewpoint.gain_m2;
  }
  decision.tour = std::move(tour);
  return decision;
}

Decision Explorer::drive_home(const Situation& now) {
  Decision decision;
  if (is_home(now)) {
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
    begin_return();
  }
  decision.reason = "Everything has been seen: driving home.";
  decision.path_map = path_home(now);
  decision.goal = waypoints_.next(grid_, decision.path_map, now.T_map_base.translation(),
                                  params_.home_tolerance_m);
  return decision;
}

bool Explorer::is_home(const Situation& now) const {
  const double distance_m = (now.T_map_base.translation() - *home_map_).norm();
  return distance_m <= params_.home_tolerance_m ||
         (now.has_arrived && distance_m <= params_.home_tolerance_m + kArrivalM);
}

void Explorer::begin_return() {
  state_ = State::kReturning;
  no_path_since_.reset();
  heads_for_home_itself_ = false;
  target_.reset();
  viewpoints_on_line_map_.clear();
}

// The path to the place nearest to home that the map shows, and on to home. From that place on it
// is home alone: the navigator may know a path, or that there is none.
std::vector<Eigen::Vector2d> Explorer::path_home(const Situation& now) {
  // The start position was in no beam, so its cell may still be unknown.
  const auto near_home = std::ranges::min_element(paths_.cells(), {}, [&](const Cell& cell) {
    return (grid_.center_of(cell) - *home_map_).squaredNorm();
  });
  const double distance_m = (grid_.center_of(*near_home) - now.T_map_base.translation()).norm();
  heads_for_home_itself_ |= distance_m < params_.goal_tolerance_m + kArrivalM;
  std::vector<Eigen::Vector2d> path_map;
  if (!heads_for_home_itself_) {
    path_map = reach().path_to(*near_home);
  }
  path_map.push_back(*home_map_);
  return path_map;
}

bool Explorer::has_no_path_for(double seconds, const Situation& now) const {
  return no_path_since_ &&
         std::chrono::abs(now.stamp - *no_path_since_) > time::from_seconds(seconds);
}

}  // namespace nodmap::explorer
