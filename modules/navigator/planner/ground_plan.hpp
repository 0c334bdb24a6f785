// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/robot/footprint.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/planner/cost_to_go.hpp"
#include "modules/navigator/planner/distance_field.hpp"
#include "modules/navigator/planner/known_ground.hpp"
#include "modules/navigator/planner/map_2d.hpp"
#include "modules/navigator/planner/plan_window.hpp"

namespace nodmap::navigator {

class Geofence;

/// What is known of the ground while a plan is made.
struct PlanBasis {
  const KnownGround& ground;
  const Map2d* map_2d = nullptr;                    ///< null: none
  const Geofence* geofence = nullptr;               ///< null: none
  const std::deque<Eigen::Vector2d>& failures_map;  ///< where the robot could not go on
  const CostToGo* beyond = nullptr;                 ///< outside of the window; null: not known
  bool waits_for_beyond = false;  ///< but it will be: no path may pass what blocks in the window
};

/// A plan in the making: prices the ground in a window by its distance to obstacles and searches
/// it, in portions. If there is no path, it tries again with what may be passable: with places
/// narrower than the body on the grid, and without the 2D map.
class GroundPlan {
 public:
  GroundPlan(const robot::Footprint& body, const PlannerParams& params);

  /// Begins a plan to a goal.
  void begin(const PlanWindow& window, const Eigen::Vector2d& goal_map, double tolerance_m);
  /// Begins a plan without a goal: to where the robot can go on, 3.5 m away from this pose.
  void begin_onward(const PlanWindow& window, const geometry::SE2& T_map_base);
  /// Gives up the plan that was begun.
  void stop() { phase_ = Phase::kIdle; }

  /// Greatest work of one call of advance(): visits of cells while the search is prepared, and
  /// cells that are searched.
  struct Portion {
    int prepared;
    int searched;
  };
  /// Continues for the robot at `p_map`. Returns true when the plan is complete.
  [[nodiscard]] bool advance(const PlanBasis& basis, const Eigen::Vector2d& p_map,
                             const Portion& portion);

  [[nodiscard]] bool is_active() const { return phase_ != Phase::kIdle; }
  /// Whether it prices ground, which is more work at once than the search.
  [[nodiscard]] bool is_preparing() const { return is_active() && phase_ != Phase::kSearch; }

  /// The plan that is complete. Exchanges it for an old one, whose memory the next plan uses.
  [[nodiscard]] const CostToGo& found() const { return search_.found(); }
  void exchange_found(CostToGo& plan) { search_.exchange_found(plan); }

  /// Without a goal a path is this long, or shorter if there is none.
  static constexpr double kOnwardM = 3.5;

 private:
  enum class Phase : std::uint8_t { kIdle, kOccupy, kMeasureDistances, kPrice, kSearch };
  /// How much a plan asks for; if that leaves no path, the next attempt is made. Relaxed: to a goal
  /// a path may be narrower than the body on the grid (GroundPlan::price_row()), without a goal it
  /// may be shorter.
  enum class Attempt : std::uint8_t { kUsual, kRelaxed, kWithoutMap, kRelaxedWithoutMap };
  /// What is known of a cell; of several the greatest counts.
  enum class Surface : std::uint8_t { kUnknown, kFreeInMap, kPossibleRamp, kFloor };

  void occupy_from_first_row();
  [[nodiscard]] int prepare_line(const PlanBasis& basis);
  void occupy_row(const PlanBasis& basis, int row);
  void occupy_boundary(const Geofence& geofence);
  void begin_search(const PlanBasis& basis);
  void read_surfaces(const PlanBasis& basis, int row);
  void price_row(const PlanBasis& basis, int row);
  void price_failures(const std::deque<Eigen::Vector2d>& failures_map);
  void read_map_row(const PlanBasis& basis, const Eigen::Vector2i& first);
  [[nodiscard]] bool is_relaxed() const {
    return attempt_ == Attempt::kRelaxed || attempt_ == Attempt::kRelaxedWithoutMap;
  }
  [[nodiscard]] bool uses_map(const PlanBasis& basis) const {
    return basis.map_2d != nullptr &&
           (attempt_ == Attempt::kUsual || attempt_ == Attempt::kRelaxed);
  }
  [[nodiscard]] bool try_next(const PlanBasis& basis);

  robot::Footprint body_;
  PlannerParams params_;
  Phase phase_ = Phase::kIdle;
  Attempt attempt_ = Attempt::kUsual;
  int row_ = 0;  // the next one to be occupied or priced
  PlanWindow window_;
  int cells_ = 1;  // of the ground, along each axis of a cell of the window
  Eigen::Vector2d goal_map_ = Eigen::Vector2d::Zero();
  double tolerance_m_ = 0.0;
  std::optional<geometry::SE2> onward_from_;  // T_map_base; empty: to the goal
  std::vector<Map2d::Kind> map_row_;          // of the ground's row that is being read
  std::vector<Surface> surfaces_;             // of the window's row that is being priced
  DistanceField obstacle_distances_;
  std::vector<float> price_;  // of a metre of path, by cell; negative: blocked
  CostSearch search_;
};

}  // namespace nodmap::navigator
