// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/sweep_plan.hpp"

#include <algorithm>
#include <cmath>

#include "modules/pitch_controller/area_of_interest.hpp"

namespace nodmap::pitch_controller {
namespace {

// At d_min, where the obstacle is met for the last time.
constexpr int kLinesOnObstacle = 2;
// One line at the end of the stopping way, and this much beyond: the bound of a nod has to be above
// the speed it is planned for, or the robot would never get faster.
constexpr double kReserve = 1.3;

// R12, and the finest step of the scanner (R3).
constexpr double kFewestScans = 15.0;
constexpr double kMostScans = 500.0;
constexpr double kFinestSpacingRad = geometry::deg_to_rad(0.25);

// The step from sweep time to d_min and back contracts to a third or better over the speeds of the
// robot; this often it is exact to a microsecond.
constexpr int kIterations = 16;

}  // namespace

double spacing_for(double obstacle_m, int lines, double distance_m, double lever_m) {
  return obstacle_m * distance_m / (lines * (distance_m * distance_m + lever_m * lever_m));
}

SweepPlanner::SweepPlanner(const PitchControllerParams& params)
    : params_(params),
      corridor_(VirtualCorridor::of(params)),
      stopping_(Stopping::of(params)),
      servo_{params.robot.head.pitch_rate_rad_s, params.robot.head.pitch_acceleration_rad_s2} {}

SweepPlan SweepPlanner::plan(double forward_mps) const {
  // The stopping way depends on the sweep time, which depends on the stopping way: a fixed point.
  SweepPlan plan;
  for (int i = 0; i < kIterations; ++i) {
    plan = plan_from(stopping_.way_m(forward_mps, stopping_.reaction_s(plan.sweep_s)), forward_mps);
  }
  return plan;
}

SweepPlan SweepPlanner::plan_from(double stopping_way_m, double forward_mps) const {
  // What appears at the end of the stopping way just after the laser has passed is looked at a
  // period later: by then the robot has come nearer.
  const double d_min_m = stopping_.way_m(forward_mps, stopping_.processing_s);
  const PitchInterval mechanics{params_.robot.head.pitch_min_rad, params_.robot.head.pitch_max_rad};
  const double period_s = params_.scan_period_s;
  SweepPlan plan;
  plan.d_min_m = d_min_m;
  plan.area =
      area_of_interest(forward_mps, params_.fast_mps, corridor_.area_from(d_min_m), mechanics);
  const double resolved_rad = std::min(
      spacing_for(params_.visible_obstacle_m, kLinesOnObstacle, corridor_.from_axis_m(d_min_m),
                  params_.robot.mount.z_m),
      spacing_for(params_.visible_obstacle_m, 1, corridor_.from_axis_m(kReserve * stopping_way_m),
                  params_.robot.mount.z_m));
  plan.line_spacing_rad =
      std::max(std::min(resolved_rad, servo_.max_speed_rad_s * period_s), kFinestSpacingRad);
  plan.sweep = {std::max(plan.area.min_rad - plan.line_spacing_rad, mechanics.min_rad),
                std::min(plan.area.max_rad + plan.line_spacing_rad, mechanics.max_rad)};

  const double range_rad = plan.sweep.range_rad();
  const double best_rad_s = servo_.best_speed_rad_s(range_rad);
  const double speed_rad_s = std::min(plan.line_spacing_rad / period_s, best_rad_s);
  plan.fastest_s = servo_.sweep_s(range_rad, best_rad_s);
  plan.slowest_s = std::max(
      plan.fastest_s,
      std::min(servo_.sweep_s(range_rad, kFinestSpacingRad / period_s), kMostScans * period_s));
  plan.sweep_s = std::clamp(servo_.sweep_s(range_rad, speed_rad_s), kFewestScans * period_s,
                            kMostScans * period_s);
  return plan;
}

}  // namespace nodmap::pitch_controller
