// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/sweep_plan.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::pitch_controller {
namespace {

// Number of lines on the smallest obstacle at d_min, where it is hit for the last time.
constexpr int kLinesOnObstacle = 2;
// One line hits the smallest obstacle out to this many times the distance at which it may appear.
// The speed bound of a sweep is then above the speed that it is planned for; otherwise the robot
// could never accelerate. 1.3 suffices for that, but between its lines, 1.7 degrees apart at 1 m/s,
// bricks of 5 cm are missed.
constexpr double kReserve = 1.4;
// The least reserve, where the robot cannot use what is farther away. With it the lines still reach
// the protected distance, and a still smaller one makes the sweeps no shorter: two lines must hit
// the obstacle at d_min.
constexpr double kMinReserve = 1.2;

// How much lower the sweep of a fast robot ends than the corridor needs. The navigator stops before
// floor on which scan lines were more than 15 cm apart. What is just nearer than the lower end of
// one sweep was crossed last when it was 2 v T_sweep farther away, where lines are sparse: from
// 1.2 m/s on too sparse. A lower end makes them denser, but the sweep longer; twice as much gains
// nothing more.
constexpr double kDipFromMps = 1.2;
constexpr double kDipRadPerMps = geometry::deg_to_rad(10.0);
constexpr double kMaxDipRad = geometry::deg_to_rad(3.0);

double floor_dip_rad(double forward_mps) {
  return std::clamp(kDipRadPerMps * (forward_mps - kDipFromMps), 0.0, kMaxDipRad);
}

// The finest step of the scanner (paper, II).
constexpr double kFinestSpacingRad = geometry::deg_to_rad(0.25);

// Each iteration reduces the error of the sweep duration to a third or less at all speeds of the
// robot; this many iterations are exact to a microsecond.
constexpr int kIterations = 16;

}  // namespace

double line_spacing_rad(double obstacle_m, int lines, double distance_m, double axis_height_m) {
  return obstacle_m * distance_m /
         (lines * (distance_m * distance_m + axis_height_m * axis_height_m));
}

SweepPlanner::SweepPlanner(const robot::RobotParams& robot, const DetectionParams& detection,
                           double fast_mps)
    : robot_(robot),
      detection_(detection),
      fast_mps_(fast_mps),
      corridor_(VirtualCorridor::of(robot)) {}

SweepPlan SweepPlanner::plan(double forward_mps, double looking_mps, const NeededView& view) const {
  // Fixed-point iteration: the distance at which an obstacle may appear and the duration of the
  // sweep depend on each other.
  SweepPlan plan;
  double appears_m = 0.0;
  for (int i = 0; i < kIterations; ++i) {
    plan = plan_from(appears_m, forward_mps, looking_mps, view);
    appears_m = plan.d_min_m + forward_mps * revisit_s(corridor_, plan.nod, appears_m, forward_mps);
  }
  return plan;
}

SweepPlan SweepPlanner::plan_from(double appears_m, double forward_mps, double looking_mps,
                                  const NeededView& view) const {
  const PitchInterval mechanics = robot_.head.pitch();
  SweepPlan plan;
  plan.d_min_m = robot_.braking.required_distance_m(forward_mps, detection_.processing_s);
  plan.area =
      area_of_interest(looking_mps, fast_mps_, corridor_.area_from(plan.d_min_m), mechanics);
  plan.line_spacing_rad = planned_spacing_rad(plan.d_min_m, appears_m, view.used_m);
  const double below_rad = plan.line_spacing_rad + floor_dip_rad(forward_mps);
  const double lowest_rad = std::min(plan.area.min_rad - below_rad, floor_from_rad(view));
  plan.sweep = {std::max(lowest_rad, mechanics.min_rad),
                std::min(plan.area.max_rad + plan.line_spacing_rad, mechanics.max_rad)};

  const robot::HeadLimits& head = robot_.head;
  const double period_s = detection_.scan_period_s;
  const double range_rad = plan.sweep.range_rad();
  const double best_rad_s = head.best_rate_rad_s(range_rad);
  const double rate_rad_s = std::min(plan.line_spacing_rad / period_s, best_rad_s);
  plan.fastest_s = head.sweep_s(range_rad, best_rad_s);
  plan.slowest_s = std::max(
      plan.fastest_s,
      std::min(head.sweep_s(range_rad, kFinestSpacingRad / period_s), kMaxScans * period_s));
  plan.sweep_s =
      std::clamp(head.sweep_s(range_rad, rate_rad_s), kMinScans * period_s, kMaxScans * period_s);
  plan.nod = {plan.sweep, head.rate_rad_s(range_rad, plan.sweep_s), 0.0};
  plan.nod.reversal_s = plan.nod.rate_rad_s / head.pitch_acceleration_rad_s2;
  return plan;
}

double SweepPlanner::floor_from_rad(const NeededView& view) const {
  return std::isfinite(view.floor_from_m)
             ? -std::atan(corridor_.axis_height_m / corridor_.from_axis_m(view.floor_from_m))
             : robot_.head.pitch().max_rad;
}

double SweepPlanner::planned_spacing_rad(double d_min_m, double appears_m, double used_m) const {
  const double until_m = std::clamp(used_m, kMinReserve * appears_m, kReserve * appears_m);
  const double resolved_rad =
      std::min(line_spacing_rad(detection_.visible_obstacle_m, kLinesOnObstacle,
                                corridor_.from_axis_m(d_min_m), corridor_.axis_height_m),
               line_spacing_rad(detection_.visible_obstacle_m, 1,
                                corridor_.from_axis_m(std::min(until_m, detection_.look_ahead_m)),
                                corridor_.axis_height_m));
  const double head_rad = robot_.head.pitch_rate_rad_s * detection_.scan_period_s;
  return std::max(std::min(resolved_rad, head_rad), kFinestSpacingRad);
}

}  // namespace nodmap::pitch_controller
