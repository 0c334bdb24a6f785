// SPDX-License-Identifier: BSD-3-Clause
// For closed-loop tests: a world of points, an ideal obstacle map of it, and a robot with the
// limits of the KURT's wheels. Of the navigator it uses the value types only.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "common/geometry/time.hpp"
#include "modules/navigator/navigator.hpp"

namespace nodmap::navigator::test {

/// Obstacles in odom, sampled every centimetre: denser than the bins of the map at any distance
/// that matters.
struct World {
  Points points_odom;

  void add_wall(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const int n = std::max(1, static_cast<int>((to - from).norm() / 0.01));
    for (int i = 0; i <= n; ++i) {
      points_odom.emplace_back(from + (to - from) * (static_cast<double>(i) / n));
    }
  }
  void add_room(double x_min, double x_max, double y_min, double y_max) {
    add_wall({x_min, y_min}, {x_max, y_min});
    add_wall({x_max, y_min}, {x_max, y_max});
    add_wall({x_max, y_max}, {x_min, y_max});
    add_wall({x_min, y_max}, {x_min, y_min});
  }
  void add_pillar(const Eigen::Vector2d& center, double radius_m) {
    const int n = std::max(8, static_cast<int>(2.0 * geometry::kPi * radius_m / 0.01));
    for (int i = 0; i < n; ++i) {
      const double angle = 2.0 * geometry::kPi * i / n;
      points_odom.emplace_back(center +
                               radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
};

/// The nearest point of each degree around the base, in base.
inline Points ideal_map(const World& world, const geometry::SE2& T_odom_base) {
  constexpr std::size_t kBins = 360;
  std::vector<Eigen::Vector2d> nearest(kBins);
  std::vector<double> range_m(kBins, std::numeric_limits<double>::infinity());
  const geometry::SE2 T_base_odom = T_odom_base.inverse();
  for (const Eigen::Vector2d& p_odom : world.points_odom) {
    const Eigen::Vector2d p = T_base_odom * p_odom;
    const double degree = geometry::rad_to_deg(std::atan2(p.y(), p.x()));
    const auto bin = static_cast<std::size_t>(std::lround(degree) + 360) % kBins;
    if (p.norm() < range_m[bin]) {
      range_m[bin] = p.norm();
      nearest[bin] = p;
    }
  }
  Points points;
  for (std::size_t i = 0; i < kBins; ++i) {
    if (std::isfinite(range_m[i])) {
      points.push_back(nearest[i]);
    }
  }
  return points;
}

/// The base: its wheels accelerate by 1.5 m/s2 and decelerate by 3 m/s2; a command takes effect 40
/// ms after the decision (bus, 10 ms period of the driver, controller of the motors).
class Robot {
 public:
  static constexpr double kStepS = 0.001;
  static constexpr double kHalfTrackM = 0.5 * 0.28 / 0.69;

  explicit Robot(const geometry::SE2& start) : T_odom_base(start) {}

  void command(double v, double w) { pending_.push_back({0.04, v, w}); }

  void step() {
    for (auto& p : pending_) {
      p.delay_s -= kStepS;
    }
    while (!pending_.empty() && pending_.front().delay_s <= 0.0) {
      goal_left_ = pending_.front().v - pending_.front().w * kHalfTrackM;
      goal_right_ = pending_.front().v + pending_.front().w * kHalfTrackM;
      pending_.erase(pending_.begin());
    }
    // Both wheel speeds change in proportion, as the driver commands them.
    const double left_needs = limit_needed(left_, goal_left_);
    const double right_needs = limit_needed(right_, goal_right_);
    const double factor = 1.0 / std::max({1.0, left_needs, right_needs});
    left_ += factor * (goal_left_ - left_);
    right_ += factor * (goal_right_ - right_);
    forward_mps = 0.5 * (left_ + right_);
    yaw_rate_rad_s = 0.5 * (right_ - left_) / kHalfTrackM;
    T_odom_base = T_odom_base * geometry::SE2{forward_mps * kStepS, 0.0, yaw_rate_rad_s * kStepS};
  }

  geometry::SE2 T_odom_base;
  double forward_mps = 0.0;
  double yaw_rate_rad_s = 0.0;

 private:
  struct Pending {
    double delay_s, v, w;
  };
  /// How many steps the change from `now` to `goal` takes.
  static double limit_needed(double now, double goal) {
    const bool slower = std::abs(goal) < std::abs(now) || goal * now < 0.0;
    return std::abs(goal - now) / ((slower ? 3.0 : 1.5) * kStepS);
  }

  std::vector<Pending> pending_;
  double left_ = 0.0;
  double right_ = 0.0;
  double goal_left_ = 0.0;
  double goal_right_ = 0.0;
};

/// Robot, world and navigator in closed loop: a map every 13.32 ms, used 15 ms later.
class ClosedLoop {
 public:
  ClosedLoop(World world_in, const geometry::SE2& start, const NavigatorParams& params = {})
      : world(std::move(world_in)), robot(start), navigator(params), params_(params) {}

  /// One decision, and the motion until the next.
  void cycle() {
    Situation now;
    now.stamp = time::Timestamp(time::from_seconds(time_s));
    now.points_base =
        move_to_base(ideal_map(world, robot.T_odom_base), robot.T_odom_base, robot.T_odom_base);
    const geometry::SE2 T_odom_map = robot.T_odom_base;
    advance(0.015);
    now.points_base = move_to_base(now.points_base, T_odom_map, robot.T_odom_base);
    now.T_odom_base = robot.T_odom_base;
    now.forward_mps = robot.forward_mps;
    now.yaw_rate_rad_s = robot.yaw_rate_rad_s;
    now.max_forward_mps = max_forward_mps;
    now.geofence = geofence;
    now.sweep_count = static_cast<std::int64_t>(time_s / 0.35);
    if (goal_odom) {
      now.goal = GoalInBase{robot.T_odom_base.inverse() * *goal_odom, 0.2};
    }
    decision = navigator.decide(now);
    robot.command(decision.forward_mps, decision.yaw_rate_rad_s);
    if (on_decision) {
      on_decision();
    }
  }

  void run(double duration_s) {
    for (const double end_s = time_s + duration_s; time_s < end_s;) {
      cycle();
    }
  }

  World world;
  Robot robot;
  Navigator navigator;
  Decision decision;
  std::optional<Eigen::Vector2d> goal_odom;
  std::function<void()> on_decision;
  const Geofence* geofence = nullptr;
  double max_forward_mps = 1.2;
  double time_s = 0.0;
  double driven_m = 0.0;
  double min_clearance_m = std::numeric_limits<double>::infinity();
  bool collided = false;

 private:
  void advance(double duration_s) {
    const int steps = static_cast<int>(std::lround(duration_s / Robot::kStepS));
    for (int i = 0; i < steps; ++i) {
      robot.step();
      driven_m += std::abs(robot.forward_mps) * Robot::kStepS;
      time_s += Robot::kStepS;
    }
    check();
  }

  void check() {
    const geometry::SE2 T_base_odom = robot.T_odom_base.inverse();
    for (const Eigen::Vector2d& p_odom : world.points_odom) {
      const Eigen::Vector2d p = T_base_odom * p_odom;
      const double dx = std::abs(p.x()) - 0.5 * params_.robot.body.length_m;
      const double dy = std::abs(p.y()) - 0.5 * params_.robot.body.width_m;
      const double clearance_m = std::max(dx, dy) < 0.0
                                     ? std::max(dx, dy)
                                     : std::hypot(std::max(dx, 0.0), std::max(dy, 0.0));
      min_clearance_m = std::min(min_clearance_m, clearance_m);
    }
    collided = collided || min_clearance_m <= 0.0;
  }

  NavigatorParams params_;
};

}  // namespace nodmap::navigator::test
