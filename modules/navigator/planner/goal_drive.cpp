// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/goal_drive.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/pose_tolerance.hpp"

namespace nodmap::navigator {
namespace {

// With less than this left to the previous goal the robot stops and plans to the new one.
constexpr double kNearlyThereM = 0.5;

// Cost of a metre without clearance, metres. With a higher one the robot would rather stop.
constexpr double kSqueezingClearanceWeight = 1.0;

// The parameters for squeezing past what the creep margin keeps it from passing. Why that is safe:
// beside the body hundreds of points are measured, with a noise of 1 cm. The nearest of them
// counts, so the surface is 2 cm farther away. A post that only a few beams hit is measured until
// the front is beside it, every 13 ms, in which the robot drives a millimetre. A cell of the local
// map is off by 1.25 cm at most, and everything higher than a sill is in the obstacle map as well.
// From 0.1 m/s the robot is stationary within 2 cm, and 5 cm are kept ahead.
NavigatorParams squeezing(NavigatorParams params) {
  params.drive.creep_margin_m =
      std::min(params.drive.creep_margin_m, params.drive.squeeze_margin_m);
  params.drive.creep_mps = std::min(params.drive.creep_mps, params.drive.squeeze_mps);
  params.drive.max_forward_mps = std::min(params.drive.max_forward_mps, params.drive.creep_mps);
  params.planner.clearance_weight =
      std::min(params.planner.clearance_weight, kSqueezingClearanceWeight);
  return params;
}

// Up to rounding: both are poses in the map, whatever the robot's pose is.
constexpr geometry::PoseTolerance kSameGoal{.distance_m = 1e-3, .rotation_rad = 1e-3};

// What a slower rotation passes is part of what the faster one passes, so it is as safe.
Decision rotating_slowly(Decision decision, double most_rad_s) {
  if (decision.forward_mps == 0.0) {
    decision.yaw_rate_rad_s = std::clamp(decision.yaw_rate_rad_s, -most_rad_s, most_rad_s);
  }
  return decision;
}

// Without a heading of the goal, that of the map.
geometry::SE2 goal_in_map(const Situation& now) {
  const geometry::SE2 T_map_base = now.T_map_base();
  geometry::SE2 goal_base{now.goal->p_base.x(), now.goal->p_base.y(), -T_map_base.yaw};
  if (now.goal->heading) {
    goal_base.yaw = now.goal->heading->yaw_rad;
  }
  return T_map_base * goal_base;
}

}  // namespace

GoalDrive::GoalDrive(const NavigatorParams& params)
    : params_(params),
      global_planner_(params.robot.body.footprint(), params.planner),
      local_planner_(params, true),
      squeezing_planner_(squeezing(params), true),
      back_out_(params),
      docking_(params.docking),
      without_motion_(PathProgress::kPatience) {}

void GoalDrive::forget_map() {
  forget_goal();
  global_planner_.forget_map();
  path_progress_.reset();
  look_around_.reset();
  without_motion_.end();
}

Decision GoalDrive::decide(const Situation& now) {
  cannot_move_ = false;
  decided_goal_map_ = goal_in_map(now);
  if (now.goal->heading) {
    return dock(now);
  }
  dock_map_.reset();
  return drive_by_plan(now);
}

Decision GoalDrive::dock(const Situation& now) {
  const geometry::SE2 goal_map = goal_in_map(now);
  if (!dock_map_ || !geometry::is_within(*dock_map_, goal_map, kSameGoal)) {
    docking_.reset();
    dock_map_ = goal_map;
  }
  const DockingStep step = docking_.next(*now.goal, now.stamp);
  switch (step.kind) {
    case DockingStep::Kind::kPlan: {
      Situation staging = now;
      staging.goal = GoalInBase{step.staging_base, Docking::kStagingToleranceM};
      return rotating_slowly(drive_by_plan(staging), params_.docking.rotation_rad_s);
    }
    case DockingStep::Kind::kMove: {
      if (auto moved = local_planner_.drive({step.forward_mps, step.yaw_rate_rad_s}, now)) {
        // The reason that slows it down is given instead.
        if (moved->behaviour != Behaviour::kBrake) {
          moved->reason = step.reason;
        }
        return *moved;
      }
      return stationary(Why::kDockBlocked);
    }
    case DockingStep::Kind::kDocked: {
      Decision docked = stationary(step.reason);
      docked.behaviour = Behaviour::kArrived;
      return docked;
    }
    case DockingStep::Kind::kStay:
    case DockingStep::Kind::kFailed:
      break;
  }
  return stationary(step.reason);
}

Decision GoalDrive::drive_by_plan(const Situation& now) {
  const geometry::SE2 T_map_base = now.T_map_base();
  const Eigen::Vector2d goal_map = T_map_base * now.goal->p_base;
  if ((goal_map - goal_map_).norm() > now.goal->tolerance_m) {
    goal_map_ = goal_map;
    path_progress_.reset();
    look_around_.reset();
    without_motion_.end();
  }
  global_planner_.step(now);
  if (const CostToGo* cost_to_go = global_planner_.cost_to_go()) {
    const double cost_m = cost_to_go->least_near(T_map_base.translation());
    if (!std::isfinite(cost_m)) {
      path_progress_.restart();
      return without_path(now);
    }
    look_around_.pause();
    watch_progress(now, cost_m);
    return drive_by(*cost_to_go, now);
  }
  path_progress_.restart();
  if (const CostToGo* former = former_plan(T_map_base.translation())) {
    return drive_by(*former, now);
  }
  return local_planner_.slow_down(Why::kPlans, now);
}

// With a new goal the robot drives on by the plan to the previous one until the new plan is
// complete, a tenth of a second later, unless it is nearly there. That is safe, because Brake does
// not depend on the plan; and near the new goal the robot slows down for that goal.
const CostToGo* GoalDrive::former_plan(const Eigen::Vector2d& p_map) const {
  const CostToGo* former = global_planner_.former_cost_to_go();
  if (former == nullptr) {
    return nullptr;
  }
  const double cost_m = former->least_near(p_map);
  return std::isfinite(cost_m) && cost_m > kNearlyThereM ? former : nullptr;
}

Decision GoalDrive::drive_by(const CostToGo& cost_to_go, const Situation& now) {
  if (const auto backed_out = back_out_.step(now)) {
    return *backed_out;
  }
  if (!back_out_.is_leaving(now)) {
    return drive_or_stay(cost_to_go, now);
  }
  // It turns away from all that 2D SLAM has mapped. What that matches a degree off in a fast
  // rotation is decimetres at the goal.
  return rotating_slowly(drive_or_stay(cost_to_go, with_rear_view(now)),
                         params_.docking.rotation_rad_s);
}

// In a tight place a rollout forwards is often free from here, none a centimetre or two on, and
// again one when the robot has backed up that far: it would move to and fro until it gives the path
// up. Therefore it squeezes on where it can. With a nodding laser this was not measured.
Decision GoalDrive::drive_or_stay(const CostToGo& cost_to_go, const Situation& now) {
  auto decision = local_planner_.drive_best(now, cost_to_go);
  const bool backs_up = decision && decision->forward_mps < 0.0;
  if (!decision || (backs_up && now.laser_is_held)) {
    const auto squeezed = squeeze(cost_to_go, now);
    if (!decision || (squeezed && squeezed->forward_mps > 0.0)) {
      decision = squeezed;
    }
  }
  if (!decision) {
    return stay(now);
  }
  without_motion_.end();
  return *decision;
}

// A robot that cannot move reports it after its patience, as it reports a goal without a path. It
// keeps trying. Time with people around does not count.
Decision GoalDrive::stay(const Situation& now) {
  without_motion_.record(now.stamp);
  if (!now.people.empty() || !without_motion_.has_begun()) {
    without_motion_.restart(now.stamp);
  }
  cannot_move_ = without_motion_.is_over(now.stamp);
  return local_planner_.slow_down(cannot_move_ ? Why::kCannotMove : local_planner_.reason_to_stay(),
                                  now);
}

std::optional<std::vector<Eigen::Vector2d>> GoalDrive::path_map(
    const geometry::SE2& T_map_base, const geometry::SE2& T_map_goal) const {
  constexpr double kLongestM = 100.0;
  constexpr std::size_t kStep = 4;  // cells
  if (!decided_goal_map_ || !geometry::is_within(*decided_goal_map_, T_map_goal, kSameGoal)) {
    return std::nullopt;
  }
  if (dock_map_ && docking_.is_docking()) {
    return std::vector{T_map_base.translation(), dock_map_->translation()};
  }
  const CostToGo* cost_to_go = global_planner_.cost_to_go();
  if (cost_to_go == nullptr) {
    return std::nullopt;
  }
  std::vector<Eigen::Vector2d> path;
  if (cannot_move_ || (dock_map_ && docking_.has_failed())) {
    return path;
  }
  if (!std::isfinite(cost_to_go->least_near(T_map_base.translation()))) {
    return path;
  }
  const auto cells = cost_to_go->path_from(T_map_base.translation(), kLongestM);
  for (std::size_t i = 0; i < cells.size(); i += kStep) {
    path.push_back(cells[i]);
  }
  if (cells.size() % kStep != 1) {
    path.push_back(cells.back());
  }
  return path;
}

// For places where no motion forwards keeps the creep margin.
std::optional<Decision> GoalDrive::squeeze(const CostToGo& cost_to_go, const Situation& now) {
  if (!now.people.empty()) {
    return std::nullopt;
  }
  auto decision = squeezing_planner_.drive_best(now, cost_to_go);
  if (decision) {
    decision->reason = Why::kSqueezes;
  }
  return decision;
}

// Without a path the robot looks around once, as far as it can turn. Then it forgets the remembered
// ground and plans again from the local map alone: remembered ground is only as accurate as the
// pose of 2D SLAM was, and what was seen from afar may be wrong. After each half minute without a
// path it does both again, and a narrow place that was given up may be free. In between it forgets
// nothing, even if there is a path for a moment: the ground may contain the wall that really closes
// the path, and forgetting it again and again, the robot would drive for ever.
Decision GoalDrive::without_path(const Situation& now) {
  if (look_around_.step(now.stamp, now.T_odom_base.yaw)) {
    global_planner_.forget_failures();
  }
  if (look_around_.wants_rotation()) {
    if (auto decision = local_planner_.rotate(0.5 * params_.planner.rotation_rad_s, now)) {
      decision->reason = Why::kNoPathLooks;
      return *decision;
    }
    look_around_.end();
  }
  if (look_around_.take_end()) {
    global_planner_.forget_ground();
  }
  return local_planner_.slow_down(Why::kNoPath, now);
}

// Time with people around does not count: they walk on, and the path is free again.
void GoalDrive::watch_progress(const Situation& now, double cost_m) {
  const Eigen::Vector2d p_map = now.T_map_base().translation();
  if (!now.people.empty()) {
    path_progress_.restart();
  }
  if (path_progress_.gives_up(now.stamp, p_map, cost_m)) {
    global_planner_.give_up_path_from(p_map);
  }
}

}  // namespace nodmap::navigator
