// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <string>
#include <utility>

#include "sim/world/world.hpp"

namespace nodmap::sim {

/// An interval of heights, metres.
struct Heights {
  double bottom_m = 0.0;
  double top_m = 0.0;
};

/// Builds a world from parts whose dimensions are drawn from a seed. Metres, world frame.
class Builder {
 public:
  Builder(std::string name, std::uint64_t seed) : engine_(seed) { world_.name = std::move(name); }

  /// A uniformly distributed number, including both ends.
  double between(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(engine_);
  }
  int count(int least, int most) {
    return std::uniform_int_distribution<int>(least, most)(engine_);
  }
  /// +1 or -1.
  double side() { return count(0, 1) == 0 ? 1.0 : -1.0; }

  void start(double x, double y, double yaw_rad) { world_.T_world_start = {x, y, yaw_rad}; }
  void start_height(double height_m) { world_.start_height_m = height_m; }
  void goal(double x, double y) { world_.goals.emplace_back(x, y); }
  Task& task() { return world_.task; }
  [[nodiscard]] const World& world() const { return world_; }

  /// Adds an upright plate between two points.
  void wall(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double thickness_m = 0.1,
            double reflectivity = kDefaultReflectivity);
  /// Adds a wall along x or y with an opening of `width_m` centred at `middle_m` from `from`.
  void wall_with_door(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double middle_m,
                      double width_m);
  /// Adds four walls just outside a rectangle.
  void walls_around(const Eigen::Vector2d& min, const Eigen::Vector2d& max);
  void box(const Eigen::Vector2d& center, const Eigen::Vector2d& size, const Heights& heights,
           double yaw_rad = 0.0, double reflectivity = kDefaultReflectivity);
  void cylinder(const Eigen::Vector2d& center, double radius_m, double height_m);
  void pit(const Eigen::Vector2d& min, const Eigen::Vector2d& max, double depth_m);
  void ramp(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double width_m);
  void actor(Actor actor) { world_.actors.push_back(std::move(actor)); }

  /// Returns the world; mirrored at the x axis for half of the seeds, so that no side is preferred.
  [[nodiscard]] World finish();

 private:
  World world_;
  std::mt19937_64 engine_;
};

/// The world mirrored at the x axis: y and all rotations change their sign.
[[nodiscard]] World mirrored(World world);

}  // namespace nodmap::sim
