// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <set>

#include "sim/body/collision.hpp"
#include "sim/body/contact_counts.hpp"
#include "sim/body/crowd.hpp"

namespace nodmap::sim {

/// Counts the contacts of the robot with obstacles, actors, and the edge of the ground that it
/// drives on. Each counts once as what it is, until the two have separated.
class Contacts {
 public:
  /// Separation after which a contact can begin again.
  static constexpr double kSeparatedM = 0.03;

  /// `collision` and `crowd` must outlive it.
  Contacts(const Collision& collision, const Crowd& crowd) : collision_(collision), crowd_(crowd) {}

  // To be called in each step in which the two touch. `speed_mps`: an upper bound of the speed of
  // all points of the body.
  /// An obstacle by its number in Collision.
  void touch_obstacle(std::size_t obstacle, double speed_mps);
  void touch_edge(const geometry::SE2& T_world_base, double speed_mps);
  /// Of a stationary robot it is a bump; of one whose body then moves towards the actor
  /// (`approaches`), also a collision.
  void touch_actor(std::size_t actor, double speed_mps, bool approaches);

  /// Ends the contacts that have separated.
  void end_separated(const BodyPose& body);

  [[nodiscard]] const ContactCounts& counts() const { return counts_; }

 private:
  // Contacts are numbered: obstacles, the edge, actors.
  [[nodiscard]] std::size_t edge() const { return collision_.size(); }
  [[nodiscard]] double distance(std::size_t contact, const BodyPose& body) const;
  /// Counts a contact with an obstacle or the edge, if it is new.
  void count_collision(std::size_t contact, double speed_mps);
  /// True if this contact is new.
  bool begin(std::size_t contact) { return touching_.insert(contact).second; }

  const Collision& collision_;
  const Crowd& crowd_;
  std::set<std::size_t> touching_;
  std::set<std::size_t> bumped_;  // of these, the bumps into which the robot has not driven
  Eigen::Vector2d edge_contact_ = Eigen::Vector2d::Zero();  // where the robot last met an edge
  ContactCounts counts_;
};

}  // namespace nodmap::sim
