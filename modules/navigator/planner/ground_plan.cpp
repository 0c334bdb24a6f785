// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/ground_plan.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/whole_steps.hpp"
#include "modules/navigator/geofence.hpp"

namespace nodmap::navigator {
namespace {

// The price is raised within this distance of a place where the robot could not go on.
constexpr double kFailureM = 0.3;
// Additional price where the grid leaves less than the least clearance. Such a place may be wider
// than it looks: an occupied cell extends up to 3.5 cm beyond the obstacle in it, and mixed pixels
// and noise add to both sides of a door. If there is no other path, the robot goes there; the
// rollouts measure what is really free.
constexpr double kTightPrice = 4.0;
// Additional price of what is an obstacle now but may be a ramp: a detour of some metres round it
// is better, one through unknown rooms is not.
constexpr double kPossibleRampPrice = 2.0;
constexpr double kRingM = 0.1;
// The farther the end of a path without a goal is from straight ahead, the more it costs, so that
// the robot turns round only if a path ahead would be 2.5 m shorter, or if there is none.
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

GroundPlan::GroundPlan(const robot::Footprint& body, const PlannerParams& params)
    : body_(body), params_(params) {}

void GroundPlan::begin(const PlanWindow& window, const Eigen::Vector2d& goal_map,
                       double tolerance_m) {
  window_ = window;
  goal_map_ = goal_map;
  tolerance_m_ = tolerance_m;
  onward_from_.reset();
  attempt_ = Attempt::kUsual;
  occupy_from_first_row();
}

void GroundPlan::begin_onward(const PlanWindow& window, const geometry::SE2& T_map_base) {
  begin(window, T_map_base.translation(), 0.0);
  onward_from_ = T_map_base;
}

void GroundPlan::occupy_from_first_row() {
  cells_ = static_cast<int>(std::lround(window_.cell_m / PlanWindow::kCellM));
  obstacle_distances_.begin(window_.origin, window_.cell_m, window_.width, window_.height);
  price_.resize(window_.num_cells());
  phase_ = Phase::kOccupy;
  row_ = 0;
}

bool GroundPlan::advance(const PlanBasis& basis, const Eigen::Vector2d& p_map,
                         const Portion& portion) {
  if (phase_ == Phase::kSearch) {
    if (search_.advance(price_, portion.searched)) {
      return false;
    }
    if (std::isfinite(search_.found().least_near(p_map)) || basis.waits_for_beyond ||
        !try_next(basis)) {
      phase_ = Phase::kIdle;
      return true;
    }
  }
  for (int visits = portion.prepared; visits > 0 && is_preparing();) {
    visits -= prepare_line(basis);
  }
  return false;
}

// Does one more line of what the search needs: blocked cells, distances to them, prices. Returns
// how many cells were visited.
int GroundPlan::prepare_line(const PlanBasis& basis) {
  if (phase_ == Phase::kOccupy) {
    occupy_row(basis, row_);
    if (++row_ == window_.height) {
      if (basis.geofence != nullptr) {
        occupy_boundary(*basis.geofence);
      }
      phase_ = Phase::kMeasureDistances;
    }
    return window_.width * cells_ * cells_;
  }
  if (phase_ == Phase::kMeasureDistances) {
    if (!obstacle_distances_.compute_line()) {
      phase_ = Phase::kPrice;
      row_ = 0;
    }
    return std::max(window_.width, window_.height);
  }
  price_row(basis, row_);
  if (++row_ == window_.height) {
    begin_search(basis);
    phase_ = Phase::kSearch;
  }
  return window_.width * cells_ * cells_;
}

void GroundPlan::begin_search(const PlanBasis& basis) {
  price_failures(basis.failures_map);
  if (onward_from_) {
    search_.begin_onward(window_, price_,
                         {*onward_from_, is_relaxed() ? kShortestM : kOnwardM - kRingM, kOnwardM,
                          kShortPrice, kAsideMPerRad});
  } else if (basis.beyond != nullptr) {
    search_.begin(window_, price_, goal_map_, tolerance_m_, *basis.beyond);
  } else {
    search_.begin(window_, price_, goal_map_, tolerance_m_, 1.0 + params_.unknown_price);
  }
}

// Begins the next attempt at this plan. Returns false after the last one.
bool GroundPlan::try_next(const PlanBasis& basis) {
  if (!is_relaxed()) {
    attempt_ = attempt_ == Attempt::kUsual ? Attempt::kRelaxed : Attempt::kRelaxedWithoutMap;
    phase_ = Phase::kPrice;
    row_ = 0;
    return true;
  }
  if (uses_map(basis)) {
    attempt_ = Attempt::kWithoutMap;
    occupy_from_first_row();
    return true;
  }
  return false;
}

// Reads a row of the 2D map, or of unknown cells if it is not used.
void GroundPlan::read_map_row(const PlanBasis& basis, const Eigen::Vector2i& first) {
  map_row_.assign(static_cast<std::size_t>(window_.width * cells_), Map2d::Kind::kUnknown);
  if (uses_map(basis)) {
    basis.map_2d->read_row(first, map_row_);
  }
}

// A coarse cell is occupied if anything in it is, or right beside it: so walls whose cells touch
// only at their corners remain closed.
void GroundPlan::occupy_row(const PlanBasis& basis, int row) {
  for (int line = 0; line < cells_; ++line) {
    const Eigen::Vector2i first =
        basis.ground.first_of(window_) + Eigen::Vector2i(0, row * cells_ + line);
    read_map_row(basis, first);
    for (int x = 0; x < window_.width * cells_; ++x) {
      const Eigen::Vector2i cell = first + Eigen::Vector2i(x, 0);
      if (basis.ground.at(cell) == KnownGround::Kind::kBlocked ||
          (map_row_[static_cast<std::size_t>(x)] == Map2d::Kind::kOccupied &&
           !basis.ground.is_seen_near(cell))) {
        obstacle_distances_.occupy(x / cells_, row);
        if (cells_ > 1) {
          obstacle_distances_.occupy(std::min((x + 1) / cells_, window_.width - 1), row);
        }
      }
    }
  }
}

void GroundPlan::occupy_boundary(const Geofence& geofence) {
  const Eigen::Vector2d half_size =
      0.5 * window_.cell_m * Eigen::Vector2i(window_.width, window_.height).cast<double>();
  const Eigen::Vector2d middle_map = window_.origin + half_size;
  for (const auto& p_map : geofence.boundary_near(middle_map, half_size.norm())) {
    const Eigen::Vector2i cell = window_.cell_of(p_map);
    if (window_.contains(cell.x(), cell.y())) {
      obstacle_distances_.occupy(cell.x(), cell.y());
    }
  }
}

// What is known of the cells of a row.
void GroundPlan::read_surfaces(const PlanBasis& basis, int row) {
  surfaces_.assign(static_cast<std::size_t>(window_.width), Surface::kUnknown);
  for (int line = 0; line < cells_; ++line) {
    const Eigen::Vector2i first =
        basis.ground.first_of(window_) + Eigen::Vector2i(0, row * cells_ + line);
    read_map_row(basis, first);
    Eigen::Vector2i cell = first;
    for (Surface& surface : surfaces_) {
      for (int i = 0; i < cells_; ++i, ++cell.x()) {
        if (basis.ground.at(cell) == KnownGround::Kind::kFloor) {
          surface = Surface::kFloor;
        } else if (basis.ground.at(cell) == KnownGround::Kind::kPossibleRamp) {
          surface = std::max(surface, Surface::kPossibleRamp);
        } else if (map_row_[static_cast<std::size_t>(cell.x() - first.x())] == Map2d::Kind::kFree) {
          surface = std::max(surface, Surface::kFreeInMap);
        }
      }
    }
  }
}

// A door that only the 2D map shows is narrower there than it is: the map is off by some
// centimetres, and noise adds to both sides. The robot goes there and looks.
void GroundPlan::price_row(const PlanBasis& basis, int row) {
  read_surfaces(basis, row);
  const bool crosses_narrow = is_relaxed() && !onward_from_;
  const double usual_m = crosses_narrow ? kOccupiedM : body_.half_width_m;
  const Prices prices{body_.half_width_m + params_.min_clearance_m, params_};
  for (int column = 0; column < window_.width; ++column) {
    const double distance_m = obstacle_distances_.at(column, row);
    float& price = price_[window_.index_of(column, row)];
    switch (surfaces_[static_cast<std::size_t>(column)]) {
      case Surface::kFloor:
        price = prices.at(distance_m, usual_m, 0.0);
        break;
      case Surface::kPossibleRamp:
        price = prices.at(distance_m, usual_m, kPossibleRampPrice);
        break;
      case Surface::kFreeInMap:
        price = prices.at(distance_m, kOccupiedM, params_.map_price);
        break;
      case Surface::kUnknown:
        price = prices.at(distance_m, usual_m, params_.unknown_price);
        break;
    }
  }
}

// Raises the price where the robot could not go on. A place that also looked too narrow is closed.
void GroundPlan::price_failures(const std::deque<Eigen::Vector2d>& failures_map) {
  const double least_m = body_.half_width_m + params_.min_clearance_m;
  const int reach = geometry::whole_steps(kFailureM, window_.cell_m);
  for (const Eigen::Vector2d& p_map : failures_map) {
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
