// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/global_planner.hpp"

#include <algorithm>
#include <cmath>

#include "modules/navigator/geofence.hpp"

namespace nodmap::navigator {
namespace {

// Cells of a portion: about 0.5 ms.
constexpr int kPortion = 8000;
// The same (2 ms) while the robot has no plan to its goal, and waits or drives by an old one.
constexpr int kFirstPortion = 4 * kPortion;
// While a search is prepared each cell is visited five times. So many visits take about 4 ms: a
// window of 22 m x 22 m is prepared at once, one of 51 m x 51 m in six portions.
constexpr int kPreparedAtOnce = 1'000'000;
// The price is raised within this distance of a place where the robot could not go on.
constexpr double kFailureM = 0.3;
// So many of them are remembered: with each the robot has made no progress for some seconds.
constexpr std::size_t kMostFailures = 50;
// Additional price where the grid leaves less than the least clearance. Such a place may be wider
// than it looks: an occupied cell extends up to 3.5 cm beyond the obstacle in it, and mixed pixels
// and noise add to both sides of a door. If there is no other path, the robot goes there; the
// rollouts measure what is really free.
constexpr double kTightPrice = 4.0;
// Additional price of what is an obstacle now but may be a ramp: a detour of some metres round it
// is better, one through unknown rooms is not.
constexpr double kPossibleRampPrice = 2.0;
// A plan older than this is not used any more, because the ground may have changed.
constexpr double kRecentS = 2.0;
// Without a goal the robot plans this far: more than two seconds, or four plans, at its fastest
// speed. The farther an end is from straight ahead, the more it costs, so that the robot turns
// round only if a path ahead would be 2.5 m shorter, or if there is none.
constexpr double kOnwardM = 3.5;
constexpr double kRingM = 0.1;
// A plan onward is dropped when the robot is farther than this from where it was made. From one
// plan to the next it drives 0.9 m at 1.5 m/s.
constexpr double kLeftM = 1.75;
constexpr double kAsideMPerRad = 0.8;
// If no path leads that far, as in a small room, a shorter one will do: at least this long, at
// this price for each metre that is missing.
constexpr double kShortestM = 0.6;
constexpr double kShortPrice = 3.0;
// As a last resort a path keeps this distance from the middle of an occupied cell: enough not to
// slip through a wall whose cells only touch at their corners, or of which one or two are missing.
constexpr double kOccupiedM = 0.1;
constexpr float kBlockedPrice = -1.0F;

// What a metre of path costs, by the distance of the robot's centre from obstacles.
struct Prices {
  double least_m;  // nearer than this it is tight
  const PlannerParams& params;

  // `blocked_m`: nearer than this no path leads through.
  [[nodiscard]] float at(double distance_m, double blocked_m, double ground_price) const {
    if (distance_m < blocked_m) {
      return kBlockedPrice;
    }
    const double nearness = std::max(0.0, 1.0 - (distance_m - least_m) / params.wide_m);
    const double tight_price = distance_m < least_m ? kTightPrice : 0.0;
    return static_cast<float>(1.0 + params.nearness_price * nearness * nearness + tight_price +
                              ground_price);
  }
};

}  // namespace

GlobalPlanner::GlobalPlanner(const robot::Footprint& body, const PlannerParams& params)
    : body_(body), params_(params) {}

void GlobalPlanner::add_failure(const Eigen::Vector2d& p_map) {
  if (failures_map_.size() == kMostFailures) {
    failures_map_.pop_front();
  }
  failures_map_.push_back(p_map);
}

void GlobalPlanner::give_up_path_from(const Eigen::Vector2d& p_map) {
  constexpr double kGiveUpAheadM = 0.4;
  add_failure(complete_->path_from(p_map, kGiveUpAheadM).back());
}

void GlobalPlanner::forget_ground() {
  ground_.forget();
  started_at_.reset();
  phase_ = Phase::kIdle;
}

void GlobalPlanner::step(const Situation& now) {
  const geometry::SE2 T_map_base = now.T_map_base();
  const Eigen::Vector2d p_map = T_map_base.translation();
  const Eigen::Vector2d goal_map = T_map_base * now.goal->p_base;
  const double tolerance_m = now.goal->tolerance_m;
  map_2d_ = now.map_2d != nullptr && !now.map_2d->is_empty() ? now.map_2d : nullptr;
  goal_is_new_ = (goal_map - goal_map_).norm() > 0.5 * tolerance_m || tolerance_m != tolerance_m_;
  if (goal_is_new_) {
    take_new_goal();
  }
  if (is_former_ && time::seconds(std::chrono::abs(now.stamp - completed_from_)) > kRecentS) {
    is_former_ = false;
    complete_.reset();
  }
  if (phase_ != Phase::kIdle) {
    go_on(p_map, now.geofence);
  } else if (start_if_due(now.stamp)) {
    goal_map_ = goal_map;
    tolerance_m_ = tolerance_m;
    goal_is_new_ = false;
    ground_.update(now);
    begin(ground_.window_around(p_map, goal_map_, map_2d_));
  }
}

// The present plan becomes the former one, and the next begins at once. If the goal has changed
// again before there is a plan to it, that plan is completed first: otherwise there would be none
// while the goal moves.
void GlobalPlanner::take_new_goal() {
  failures_map_.clear();
  if (cost_to_go() != nullptr) {
    is_former_ = true;
    phase_ = Phase::kIdle;
  }
  if (phase_ == Phase::kIdle) {
    started_at_.reset();
  }
}

void GlobalPlanner::step_onward(const Situation& now) {
  const geometry::SE2 T_map_base = now.T_map_base();
  // The last plan onward may have been made elsewhere, before the robot drove to a goal.
  if (onward_from_ && (T_map_base.translation() - onward_from_->translation()).norm() > kLeftM) {
    complete_.reset();
    phase_ = Phase::kIdle;
  }
  if (phase_ != Phase::kIdle) {
    go_on(T_map_base.translation(), now.geofence);
  } else if (start_if_due(now.stamp)) {
    ground_.update(now);
    begin(ground_.window_within(T_map_base.translation(), kOnwardM + 2.0 * KnownGround::kCellM));
    onward_from_ = T_map_base;
  }
}

// Starts the time to the next plan, if the last one began long enough ago.
bool GlobalPlanner::start_if_due(time::Timestamp stamp) {
  if (started_at_ && time::seconds(std::chrono::abs(stamp - *started_at_)) < params_.replan_s) {
    return false;
  }
  started_at_ = stamp;
  attempt_ = Attempt::kUsual;
  return true;
}

void GlobalPlanner::begin(const PlanWindow& window) {
  window_ = window;
  obstacle_distances_.begin(window.origin, PlanWindow::kCellM, window.width, window.height);
  price_.resize(window.num_cells());
  phase_ = Phase::kOccupy;
  row_ = 0;
}

void GlobalPlanner::go_on(const Eigen::Vector2d& p_map, const Geofence* geofence) {
  if (phase_ == Phase::kSearch) {
    if (search_.advance(price_, complete_ && !is_former_ ? kPortion : kFirstPortion)) {
      return;
    }
    finish(p_map);
  }
  for (int cells = kPreparedAtOnce;
       cells > 0 && phase_ != Phase::kSearch && phase_ != Phase::kIdle;) {
    cells -= prepare_line(geofence);
  }
}

// Does one more line of what the search needs: blocked cells, distances to them, prices. Returns
// how many cells that were.
int GlobalPlanner::prepare_line(const Geofence* geofence) {
  if (phase_ == Phase::kOccupy) {
    occupy_row(row_);
    if (++row_ == window_.height) {
      if (geofence != nullptr) {
        occupy_boundary(*geofence);
      }
      phase_ = Phase::kMeasureDistances;
    }
    return window_.width;
  }
  if (phase_ == Phase::kMeasureDistances) {
    if (!obstacle_distances_.compute_line()) {
      phase_ = Phase::kPrice;
      row_ = 0;
    }
    return std::max(window_.width, window_.height);
  }
  price_row(row_);
  if (++row_ == window_.height) {
    begin_search();
    phase_ = Phase::kSearch;
  }
  return window_.width;
}

void GlobalPlanner::begin_search() {
  price_failures();
  if (onward_from_) {
    search_.begin_onward(window_, price_,
                         {*onward_from_, is_tight() ? kShortestM : kOnwardM - kRingM, kOnwardM,
                          kShortPrice, kAsideMPerRad});
  } else {
    search_.begin(window_, price_, goal_map_, tolerance_m_, 1.0 + params_.unknown_price);
  }
}

// If there is no path, tries the next attempt.
void GlobalPlanner::finish(const Eigen::Vector2d& p_map) {
  if (!std::isfinite(search_.found().least_near(p_map)) && try_next()) {
    return;
  }
  search_.exchange_found(complete_ ? *complete_ : complete_.emplace());
  completed_from_ = *started_at_;
  is_former_ = goal_is_new_;
  phase_ = Phase::kIdle;
}

// Begins the next attempt at this plan. Returns false after the last one.
bool GlobalPlanner::try_next() {
  if (!is_tight()) {
    attempt_ = attempt_ == Attempt::kUsual ? Attempt::kTight : Attempt::kTightWithoutMap;
    phase_ = Phase::kPrice;
    row_ = 0;
    return true;
  }
  if (uses_map()) {
    attempt_ = Attempt::kWithoutMap;
    begin(window_);
    return true;
  }
  return false;
}

// Reads a row of the 2D map, or of unknown cells if it is not used.
void GlobalPlanner::read_map_row(const Eigen::Vector2i& first) {
  map_row_.assign(static_cast<std::size_t>(window_.width), Map2d::Kind::kUnknown);
  if (uses_map()) {
    map_2d_->read_row(first, map_row_);
  }
}

// The 2D map is off by some centimetres: beside what the local map has shown its walls do not
// count.
void GlobalPlanner::occupy_row(int row) {
  const Eigen::Vector2i first = ground_.first_of(window_) + Eigen::Vector2i(0, row);
  read_map_row(first);
  for (int column = 0; column < window_.width; ++column) {
    const Eigen::Vector2i cell = first + Eigen::Vector2i(column, 0);
    if (ground_.at(cell) == KnownGround::Kind::kBlocked ||
        (map_row_[static_cast<std::size_t>(column)] == Map2d::Kind::kOccupied &&
         !ground_.is_seen_near(cell))) {
      obstacle_distances_.occupy(column, row);
    }
  }
}

void GlobalPlanner::occupy_boundary(const Geofence& geofence) {
  const Eigen::Vector2d half_size =
      0.5 * PlanWindow::kCellM * Eigen::Vector2i(window_.width, window_.height).cast<double>();
  const Eigen::Vector2d middle_map = window_.origin + half_size;
  for (const auto& p_map : geofence.boundary_near(middle_map, half_size.norm())) {
    const Eigen::Vector2i cell = window_.cell_of(p_map);
    if (window_.contains(cell.x(), cell.y())) {
      obstacle_distances_.occupy(cell.x(), cell.y());
    }
  }
}

// A door that only the 2D map shows is narrower there than it is: the map is off by some
// centimetres, and noise adds to both sides. The robot goes there and looks.
void GlobalPlanner::price_row(int row) {
  const Eigen::Vector2i first = ground_.first_of(window_) + Eigen::Vector2i(0, row);
  read_map_row(first);
  const bool crosses_tight = is_tight() && !onward_from_;
  const double usual_m = crosses_tight ? kOccupiedM : body_.half_width_m;
  const Prices prices{body_.half_width_m + params_.min_clearance_m, params_};
  for (int column = 0; column < window_.width; ++column) {
    const double distance_m = obstacle_distances_.at(column, row);
    float& price = price_[window_.index_of(column, row)];
    if (ground_.at(first + Eigen::Vector2i(column, 0)) == KnownGround::Kind::kFloor) {
      price = prices.at(distance_m, usual_m, 0.0);
    } else if (ground_.at(first + Eigen::Vector2i(column, 0)) == KnownGround::Kind::kPossibleRamp) {
      price = prices.at(distance_m, usual_m, kPossibleRampPrice);
    } else if (map_row_[static_cast<std::size_t>(column)] == Map2d::Kind::kFree) {
      price = prices.at(distance_m, kOccupiedM, params_.map_price);
    } else {
      price = prices.at(distance_m, usual_m, params_.unknown_price);
    }
  }
}

// Raises the price where the robot could not go on. A place that also looked too narrow is closed.
void GlobalPlanner::price_failures() {
  const double least_m = body_.half_width_m + params_.min_clearance_m;
  const int reach = static_cast<int>(kFailureM / PlanWindow::kCellM);
  for (const Eigen::Vector2d& p_map : failures_map_) {
    const Eigen::Vector2i middle = window_.cell_of(p_map);
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const int column = middle.x() + dx;
        const int row = middle.y() + dy;
        if (!window_.contains(column, row) || dx * dx + dy * dy > reach * reach ||
            price_[window_.index_of(column, row)] <= 0.0F) {
          continue;
        }
        float& price = price_[window_.index_of(column, row)];
        price = obstacle_distances_.at(column, row) < least_m
                    ? kBlockedPrice
                    : std::min(CostSearch::kHighestPrice,
                               price + static_cast<float>(params_.failure_price));
      }
    }
  }
}

}  // namespace nodmap::navigator
