// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/robot/footprint.hpp"
#include "modules/navigator/behaviours/side.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/planner/body_clearance.hpp"
#include "modules/navigator/planner/cost_to_go.hpp"
#include "modules/navigator/situation.hpp"
#include "modules/navigator/twist.hpp"

namespace nodmap::navigator {

/// A motion to command now, and what it leads to.
struct Rollout {
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
  double next_yaw_rate_rad_s = 0.0;  ///< in the second half
  double cost_m = 0.0;               ///< less is better
};

/// Rates up to 881 motions of the next 1.6 s. Each is an arc followed by another one, within the
/// accelerations of the base: forwards, backwards, on the spot and, if there are people,
/// stationary. Those that touch something are left out; for that it measures the body's clearance
/// at any pose. The others cost the sum of five terms: the plan's cost of their end, nearness to
/// obstacles, the time for which they obstruct people, the change of motion, and a price for
/// driving backwards.
///
/// For 3 s the body is compared at each step with the predicted places of people. Once somebody
/// touches it, all the rest of the rollout obstructs: the later that is, the less it costs. After
/// its end a rollout is continued by driving on or by stopping, whichever obstructs less.
///
/// A rollout that comes within the goal's tolerance ends there. Otherwise a goal that is nearer
/// than the slowest rollout is long could not be reached. The sooner it does, the less it costs.
class Rollouts {
 public:
  static constexpr double kDurationS = 1.6;

  explicit Rollouts(const NavigatorParams& params);

  /// The rollouts that touch nothing, by increasing cost. Valid until the next call.
  [[nodiscard]] const std::vector<Rollout>& plan(const Situation& now, const CostToGo& cost_to_go,
                                                 double max_forward_mps);

 private:
  /// The state of a rollout after some steps.
  struct Progress {
    int steps = 0;
    geometry::SE2 pose_base;  // in base, now
    Twist twist;
    double obstruction_s = 0.0;
    bool is_touched = false;   // by somebody who moves
    bool has_arrived = false;  // within the goal's tolerance, where the motion ends
    double nearness_m = 0.0;   // metres driven, weighted by their nearness to obstacles
  };

  void consider_forwards(double forward_mps, const Situation& now, const CostToGo& cost_to_go);
  void consider(const Twist& motion, const Situation& now, const CostToGo& cost_to_go);
  [[nodiscard]] static Progress start(const Situation& now);
  [[nodiscard]] bool advance(Progress& progress, const Twist& motion, int until_step,
                             const Situation& now) const;
  void meet_people(Progress& progress, const People& people) const;
  [[nodiscard]] double foreseen_obstruction_s(const Progress& end, const People& people) const;
  [[nodiscard]] double foresee(Progress progress, bool stops, const People& people) const;
  void add(const Twist& first, double next_yaw_rate_rad_s, const Progress& end,
           const Situation& now, const CostToGo& cost_to_go);
  [[nodiscard]] double rotation_cost(const geometry::SE2& T_map_end, Side side, double yaw_rad,
                                     const CostToGo& cost_to_go) const;
  [[nodiscard]] double least_clearance_m(const Twist& motion, double forward_mps) const;
  /// How much a pose obstructs people at a time, from 0 to 1 in the middle of somebody's path.
  [[nodiscard]] double obstruction(const geometry::SE2& pose_base, double time_s,
                                   const People& people) const;

  robot::Footprint body_;
  PlannerParams params_;
  DriveParams drive_params_;
  BaseParams base_params_;
  PeopleParams people_params_;
  BodyClearance clearance_;
  double least_clearance_m_ = 0.0;
  double least_creeping_clearance_m_ = 0.0;  // forwards, no faster than Brake creeps
  double least_slow_clearance_m_ = 0.0;      // on the spot and backwards
  double reverse_price_m_ = 0.0;
  double free_left_rad_ = 0.0;  // on the spot
  double free_right_rad_ = 0.0;
  std::vector<Rollout> rollouts_;
};

}  // namespace nodmap::navigator
