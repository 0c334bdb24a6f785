// SPDX-License-Identifier: BSD-3-Clause
// Prints the tables of modules/pitch_controller/README.md: what the defaults give.
#include <algorithm>
#include <cstdio>
#include <initializer_list>

#include "common/geometry/angle.hpp"
#include "modules/pitch_controller/speed_bound.hpp"
#include "modules/pitch_controller/sweep_plan.hpp"

namespace nodmap::pitch_controller {
namespace {

using geometry::deg_to_rad;
using geometry::rad_to_deg;

void print_plans(const PitchControllerParams& params) {
  const SweepPlanner planner(params);
  const VirtualCorridor corridor = VirtualCorridor::of(params);
  const Stopping stopping = Stopping::of(params);
  std::puts(
      "| speed m/s | d_min m | area of interest deg | spacing deg | T* s (scans) | T_w s "
      "| clear view m | bound m/s |\n|---|---|---|---|---|---|---|---|");
  for (const double v : {0.0, 0.5, 1.0, 1.5, 2.0}) {
    const SweepPlan plan = planner.plan(v);
    const ClearView view = clear_view(corridor, plan.sweep, plan.line_spacing_rad,
                                      params.visible_obstacle_m, params.look_ahead_m);
    const double bound_mps = speed_bound(view, plan.sweep_s, stopping);
    std::printf("| %.1f | %.2f | %.1f .. %.1f | %.2f | %.2f (%.0f) | %.2f | %.2f .. %.2f | ", v,
                plan.d_min_m, rad_to_deg(plan.area.min_rad), rad_to_deg(plan.area.max_rad),
                rad_to_deg(plan.line_spacing_rad), plan.sweep_s,
                plan.sweep_s / params.scan_period_s, stopping.reaction_s(plan.sweep_s), view.near_m,
                view.far_m);
    std::printf(bound_mps > params.top_mps ? "%.2f (`top_mps`; %.2f) |\n" : "%.2f |\n",
                std::min(bound_mps, params.top_mps), bound_mps);
  }
}

/// T_w of a nod over a fixed range with the lines of the plan.
double fixed_reaction_s(const SweepPlan& plan, double range_rad,
                        const PitchControllerParams& params) {
  const Servo servo{params.robot.head.pitch_rate_rad_s,
                    params.robot.head.pitch_acceleration_rad_s2};
  const double rate_rad_s =
      std::min(plan.line_spacing_rad / params.scan_period_s, servo.best_speed_rad_s(range_rad));
  return Stopping::of(params).reaction_s(servo.sweep_s(range_rad, rate_rad_s));
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
    params.visible_obstacle_m = c.obstacle_m;
    const SweepPlan plan = SweepPlanner(params).plan(c.speed_mps);
    std::printf("| %.0f cm | %.1f m/s | %.2f s | %.2f s | %.2f s |\n", 100.0 * c.obstacle_m,
                c.speed_mps, Stopping::of(params).reaction_s(plan.sweep_s),
                fixed_reaction_s(plan, deg_to_rad(55.0), params),
                fixed_reaction_s(plan, deg_to_rad(120.0), params));
  }
}

}  // namespace
}  // namespace nodmap::pitch_controller

int main() {
  nodmap::pitch_controller::print_plans({});
  nodmap::pitch_controller::print_reactions();
  return 0;
}
