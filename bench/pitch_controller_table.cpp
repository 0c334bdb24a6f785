// SPDX-License-Identifier: BSD-3-Clause
// Prints the tables of modules/pitch_controller/README.md from the default parameters.
#include <algorithm>
#include <cstdio>
#include <initializer_list>
#include <limits>

#include "common/geometry/angle.hpp"
#include "modules/pitch_controller/speed_bound.hpp"
#include "modules/pitch_controller/sweep_plan.hpp"
#include "modules/pitch_controller/test/control_loop.hpp"

namespace nodmap::pitch_controller {
namespace {

using geometry::deg_to_rad;
using geometry::rad_to_deg;

// `used_m`: how far ahead the robot can use what it sees.
void print_plans(const PitchControllerParams& params, double used_m) {
  const DetectionParams& detection = params.detection;
  const SweepPlanner planner(params.robot, detection, params.speed.fast_mps);
  const VirtualCorridor corridor = VirtualCorridor::of(params.robot);
  std::puts(
      "\n| speed m/s | d_min m | area of interest deg | spacing deg | T_sweep s (scans) | T s "
      "| clear view m | bound m/s |\n|---|---|---|---|---|---|---|---|");
  for (const double v : {0.0, 0.5, 1.0, 1.5, 2.0}) {
    const SweepPlan plan = planner.plan(v, v, {.used_m = used_m});
    const ClearView view = clear_view(corridor, plan.sweep, plan.line_spacing_rad,
                                      detection.visible_obstacle_m, detection.look_ahead_m);
    const double bound_mps =
        speed_bound({view, plan.nod}, {}, corridor, params.robot.braking, detection);
    std::printf("| %.1f | %.2f | %.1f .. %.1f | %.2f | %.2f (%.0f) | %.2f | %.2f .. %.2f | ", v,
                plan.d_min_m, rad_to_deg(plan.area.min_rad), rad_to_deg(plan.area.max_rad),
                rad_to_deg(plan.line_spacing_rad), plan.sweep_s,
                plan.sweep_s / detection.scan_period_s, detection.reaction_s(plan.sweep_s),
                view.near_m, view.far_m);
    std::printf(bound_mps > params.speed.top_mps ? "%.2f (`top_mps`; %.2f) |\n" : "%.2f |\n",
                std::min(bound_mps, params.speed.top_mps), bound_mps);
  }
}

// Reaction time (s) of sweeps over a fixed range with the line spacing of `plan`.
double fixed_reaction_s(const SweepPlan& plan, double range_rad,
                        const PitchControllerParams& params) {
  const robot::HeadLimits& head = params.robot.head;
  const double rate_rad_s = std::min(plan.line_spacing_rad / params.detection.scan_period_s,
                                     head.best_rate_rad_s(range_rad));
  return params.detection.reaction_s(head.sweep_s(range_rad, rate_rad_s));
}

void print_reactions() {
  struct Case {
    double obstacle_m, speed_mps;
  };
  std::puts(
      "\n| smallest obstacle above the floor tolerance | speed | this plan "
      "| fixed 55 deg (the driver's own area) | fixed 120 deg |\n|---|---|---|---|---|");
  for (const Case& c : {Case{0.03, 1.5}, {0.05, 1.0}, {0.05, 1.5}, {0.10, 1.5}, {0.20, 1.5}}) {
    PitchControllerParams params;
    params.detection.visible_obstacle_m = c.obstacle_m;
    const SweepPlan plan =
        SweepPlanner(params.robot, params.detection, params.speed.fast_mps).plan(c.speed_mps);
    std::printf("| %.0f cm | %.1f m/s | %.2f s | %.2f s | %.2f s |\n", 100.0 * c.obstacle_m,
                c.speed_mps, params.detection.reaction_s(plan.sweep_s),
                fixed_reaction_s(plan, deg_to_rad(55.0), params),
                fixed_reaction_s(plan, deg_to_rad(120.0), params));
  }
}

// How soon a robot that drives as fast as permitted, from rest, is at a speed, s. The base
// accelerates at 1.5 m/s^2.
double reached_after_s(test::Loop& loop, double wanted_mps, time::Timestamp start) {
  constexpr double kBaseStepMps = 1.5 * 0.01;
  const double limit_mps = wanted_mps - 1e-6;
  while (loop.speed < limit_mps && loop.now - start < 30s) {
    loop.run(0.01,
             [&] { return std::min(loop.speed + kBaseStepMps, loop.decision.max_forward_mps); });
  }
  return time::seconds(loop.now - start);
}

void print_accelerations() {
  PitchControllerParams follows;
  follows.follows_path = true;
  test::Loop by_speed;
  test::Loop by_plan(follows);
  by_plan.free_m = 0.0;
  by_speed.run(5.0, 0.0);
  by_plan.run(5.0, 0.0);
  const time::Timestamp start = by_speed.now;
  std::puts("\n| from rest to | by speed, after | by plan on a short arc, after |\n|---|---|---|");
  for (const double wanted_mps : {0.5, 1.0, 1.5}) {
    const double by_speed_s = reached_after_s(by_speed, wanted_mps, start);
    const double by_plan_s = reached_after_s(by_plan, wanted_mps, start);
    std::printf("| %.1f m/s | %.1f s | %.1f s |\n", wanted_mps, by_speed_s, by_plan_s);
  }
}

}  // namespace
}  // namespace nodmap::pitch_controller

int main() {
  nodmap::pitch_controller::print_plans({}, std::numeric_limits<double>::infinity());
  nodmap::pitch_controller::print_plans({}, 0.0);
  nodmap::pitch_controller::print_reactions();
  nodmap::pitch_controller::print_accelerations();
  return 0;
}
