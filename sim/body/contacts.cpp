// SPDX-License-Identifier: BSD-3-Clause
#include "sim/body/contacts.hpp"

#include <limits>

namespace nodmap::sim {
namespace {

// Below this speed the robot counts as stationary: an actor that touches it has walked into it.
constexpr double kStationaryMps = 0.05;

}  // namespace

void Contacts::touch_obstacle(std::size_t obstacle, double speed_mps) {
  count_collision(obstacle, speed_mps);
}

void Contacts::touch_edge(const geometry::SE2& T_world_base, double speed_mps) {
  edge_contact_ = T_world_base.translation();
  count_collision(edge(), speed_mps);
}

void Contacts::count_collision(std::size_t contact, double speed_mps) {
  if (!begin(contact)) {
    return;
  }
  ++counts_.collisions;
  counts_.contacts_caused += speed_mps >= kStationaryMps ? 1 : 0;
  counts_.falls += contact == edge() || collision_.is_pit(contact) ? 1 : 0;
}

void Contacts::touch_actor(std::size_t actor, double speed_mps, bool approaches) {
  const std::size_t contact = edge() + 1 + actor;
  const bool is_new = begin(contact);
  const bool is_stationary = speed_mps < kStationaryMps;
  if (is_new && is_stationary) {
    ++counts_.bumps;
    bumped_.insert(contact);
  } else if (is_new || (!is_stationary && approaches && bumped_.erase(contact) > 0)) {
    ++counts_.collisions;
    ++counts_.contacts_caused;
  }
}

void Contacts::end_separated(const BodyPose& body) {
  std::erase_if(touching_,
                [&](std::size_t contact) { return distance(contact, body) > kSeparatedM; });
  std::erase_if(bumped_, [&](std::size_t contact) { return !touching_.contains(contact); });
}

double Contacts::distance(std::size_t contact, const BodyPose& body) const {
  if (contact < edge()) {
    return collision_.distance(contact, body);
  }
  if (contact == edge()) {
    return (body.T_world_base.translation() - edge_contact_).norm();
  }
  const std::size_t actor = contact - edge() - 1;
  return crowd_.is_present(actor) ? collision_.distance(crowd_.state(actor), body)
                                  : std::numeric_limits<double>::infinity();
}

}  // namespace nodmap::sim
