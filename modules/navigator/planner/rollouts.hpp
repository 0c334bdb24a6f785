// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "common/robot/footprint.hpp"
#include "modules/navigator/decision.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/people/foresight.hpp"
#include "modules/navigator/planner/distance_field.hpp"
#include "modules/navigator/planner/global_planner.hpp"

namespace nodmap::navigator {

/// A motion to command now, and what it leads to.
struct Rollout {
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;
  double next_yaw_rate_rad_s = 0.0;  ///< in its second half
  double cost = 0.0;                 ///< the least is best
};

/// The local planner: at most 880 motions of the next 1.6 s, each an arc followed by another one,
/// with the accelerations of the base, forwards, backwards and on the spot. Those that touch
/// something are left out; the others cost by what the global plan says of where they end, by how
/// near they pass obstacles, by how much they lie in the way of people, and by how much they differ
/// from what the robot does. Where people are, to stand is one of them: speed and yaw rate are 0.
///
/// Each moment of the next 3 s the body is compared with where people are then. From the moment on
/// at which somebody touches it, all of a rollout is in his way: the later, the better, and best
/// is what gets out of his way. After a rollout the robot goes on or stops, whichever is better.
///
/// A rollout that comes within the goal's tolerance ends there, as the robot will: otherwise it
/// would seem to lead past a goal that is nearer than the slowest rollout is long.
class Rollouts {
 public:
  static constexpr double kDurationS = 1.6;

  Rollouts(const robot::Footprint& body, const NavigatorParams& params);

  /// Those that touch nothing, best first. Valid until the next call.
  [[nodiscard]] const std::vector<Rollout>& plan(const Situation& now, const CostToGo& cost_to_go,
                                                 double max_forward_mps);

  /// From the border of the body at a pose (in base, now) to the nearest obstacle, metres; negative
  /// inside. Exact below 6 cm where the pose is within 0.5 m, else to 3.5 cm.
  [[nodiscard]] double clearance_m(const geometry::SE2& pose_base) const;

  /// Of the points in base, within 2.5 m.
  void measure_clearance(const Points& points_base);

 private:
  /// Discs that cover the body.
  struct Disc {
    Eigen::Vector2d center;
    double radius_m = 0.0;
  };

  /// What a motion has led to after some steps.
  struct Progress {
    int steps = 0;
    geometry::SE2 pose_base;  // in base, now
    Twist twist;
    double obstruction_s = 0.0;
    bool is_touched = false;   // by somebody who moves
    bool has_arrived = false;  // within the goal's tolerance, where the motion ends
    double nearness_m = 0.0;   // metres driven, each the more the nearer it is to obstacles
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
  [[nodiscard]] double clearance_by_cells_m(const geometry::SE2& pose_base) const;
  [[nodiscard]] double least_clearance_m(const Twist& motion, double forward_mps) const;
  /// How much a pose at a time is in the way of people: 1 in the middle of somebody's path.
  [[nodiscard]] double obstruction(const geometry::SE2& pose_base, double time_s,
                                   const People& people) const;

  robot::Footprint body_;
  PlannerParams params_;
  DriveParams drive_;
  PeopleParams people_;
  std::vector<Disc> discs_;
  DistanceField obstacles_;
  Points near_points_base_;  // of them, those that a slow motion can come near
  double least_clearance_m_ = 0.0;
  double least_creeping_clearance_m_ = 0.0;  // forwards, no faster than Brake creeps
  double least_slow_clearance_m_ = 0.0;      // on the spot and backwards
  double reverse_price_m_ = 0.0;
  std::vector<Rollout> rollouts_;
};

}  // namespace nodmap::navigator
