// SPDX-License-Identifier: BSD-3-Clause
#include "sim/truth_message.hpp"

#include "common/node/messages.hpp"

namespace nodmap::sim {

nodmap::truth_t write_truth(const GroundTruth& truth, time::Timestamp stamp) {
  nodmap::truth_t message{};
  message.utime = time::to_utime(stamp);
  node::write_pose(truth.T_world_base, message.position_m, message.orientation);
  message.forward_mps = truth.forward_mps;
  message.yaw_rate_rad_s = truth.yaw_rate_rad_s;
  message.pitch_rad = truth.pitch_rad;
  message.clearance_m = truth.clearance_m;
  message.collisions = truth.contacts.collisions;
  message.bumps = truth.contacts.bumps;
  message.num_actors = static_cast<std::int32_t>(truth.actors.size());
  for (const ActorState& actor : truth.actors) {
    message.actor_position_m.push_back({actor.position.x(), actor.position.y()});
    message.actor_radius_m.push_back(actor.radius_m);
    message.actor_height_m.push_back(actor.height_m);
  }
  return message;
}

}  // namespace nodmap::sim
