// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/geometry/se2.hpp"
#include "sim/body/gait.hpp"
#include "sim/body/params.hpp"
#include "sim/world/world.hpp"

namespace nodmap::sim {

/// Moves the actors of a world, without chance. Those that do not react follow their paths exactly.
/// Those that react follow the social force model (Helbing, Farkas and Vicsek, Simulating dynamical
/// features of escape panic, Nature 2000, without its contact forces; sight limited as in Helbing
/// et al. 2005): a desired velocity towards the next waypoint, and repulsion from other actors,
/// walls and the robot.
class Crowd {
 public:
  Crowd(const World& world, const BodyParams& robot);

  /// Advances all actors to `time_s`, at most a few milliseconds after the last call.
  void advance(double time_s, const geometry::SE2& T_world_robot);

  [[nodiscard]] bool is_present(std::size_t actor) const {
    return actors_[actor].is_present(time_s_);
  }
  [[nodiscard]] ActorState state(std::size_t actor) const;
  [[nodiscard]] std::size_t size() const { return actors_.size(); }
  /// Copies the states of the actors that are present.
  void copy_present(std::vector<ActorState>& states) const;

 private:
  struct Walker {
    Eigen::Vector2d position;
    Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
    std::size_t next = 0;  ///< waypoint
  };
  struct Disc {
    Eigen::Vector2d center;
    double radius_m;
  };

  void walk(const geometry::SE2& T_world_robot, double dt_s);
  void update_velocity(std::size_t actor, double dt_s, const Disc& robot);
  /// The velocity that an undisturbed walker would have.
  [[nodiscard]] Eigen::Vector2d desired_velocity(std::size_t actor);
  /// The acceleration by everything that the walker keeps away from.
  [[nodiscard]] Eigen::Vector2d repulsion(std::size_t actor, const Disc& robot) const;

  std::vector<Actor> actors_;
  std::vector<Object> walls_;  // objects that people do not step over
  double robot_radius_m_;
  double time_s_ = 0.0;
  double updated_s_ = 0.0;
  bool any_reacts_ = false;
  std::vector<Walker> walkers_;  // of all actors; used for those that react
  std::vector<Gait> gaits_;      // of all actors; used for those with legs
};

}  // namespace nodmap::sim
