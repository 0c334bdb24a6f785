// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/witness.hpp"

#include <algorithm>

#include "common/node/messages.hpp"
#include "nodmap/drive_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/truth_t.hpp"
#include "tools/trial/epoch.hpp"

namespace nodmap::trial {
namespace {

constexpr std::int64_t kRecordPeriodUs = 10'000;
constexpr std::int64_t kTruthPeriodUs = 20'000;
/// Where the mirror is, to see past what stands between it and an actor.
constexpr double kMirrorHeightM = 0.38;

}  // namespace

Witness::Witness(const sim::World& world, const sim::Plant& plant, bus::LoopNetwork& network,
                 const StoppingWay& way)
    : world_(world), plant_(plant), caster_(world), bus_(network), brake_(way) {
  subscribe();
}

void Witness::subscribe() {
  bus_.subscribe<nodmap::scan_t>("SCAN", [this](const nodmap::scan_t& /*message*/) {
    record_.began_us = record_.began_us.value_or(plant_.now_us());
  });
  bus_.subscribe<nodmap::drive_t>("DRIVE", [this](const nodmap::drive_t& message) {
    brake_.hear_drive(plant_.now_us(), message.forward_mps);
  });
  bus_.subscribe<nodmap::pitch_state_t>(
      "PITCH_STATE", [this](const nodmap::pitch_state_t& message) { on_pitch_state(message); });
  bus_.subscribe<nodmap::odometry_t>("ODOMETRY", [this](const nodmap::odometry_t& message) {
    if (const auto T_odom_base = node::read_odometry(message)) {
      record_.odometry.push_back({message.utime, *T_odom_base});
    }
  });
  bus_.subscribe<nodmap::navigation_t>("NAVIGATION", [this](const nodmap::navigation_t& message) {
    if (message.behaviour == nodmap::navigation_t::ARRIVED) {
      record_.arrived_us = record_.arrived_us.value_or(plant_.now_us());
    }
  });
}

void Witness::on_pitch_state(const nodmap::pitch_state_t& message) {
  if (sweep_ && message.sweep_count != *sweep_) {
    record_.turns_us.push_back(message.utime - kEpochUs);
  }
  sweep_ = message.sweep_count;
}

void Witness::look() {
  const std::int64_t now_us = plant_.now_us();
  const bool recorded = now_us % kRecordPeriodUs == 0;
  if (!recorded && world_.actors.empty()) {
    return;
  }
  const sim::Truth truth = plant_.truth();
  if (recorded) {
    record_.truth.push_back({now_us, truth.T_world_base, truth.forward_mps, truth.yaw_rate_rad_s,
                             truth.clearance_m, truth.collisions, truth.bumps});
  }
  if (now_us % kTruthPeriodUs == 0) {
    publish(truth);
  }
  if (!world_.actors.empty()) {
    watch_actors(truth);
  }
}

void Witness::publish(const sim::Truth& truth) {
  nodmap::truth_t message{};
  message.utime = kEpochUs + plant_.now_us();
  message.truth_seq = truth_seq_++;
  node::write_pose(truth.T_world_base, message.position_m, message.orientation);
  message.forward_mps = truth.forward_mps;
  message.yaw_rate_rad_s = truth.yaw_rate_rad_s;
  message.pitch_rad = truth.pitch_rad;
  message.clearance_m = truth.clearance_m;
  message.collisions = truth.collisions;
  message.bumps = truth.bumps;
  message.num_actors = static_cast<std::int32_t>(truth.actors.size());
  for (const sim::ActorState& actor : truth.actors) {
    message.actor_position_m.push_back({actor.position.x(), actor.position.y()});
    message.actor_radius_m.push_back(actor.radius_m);
    message.actor_height_m.push_back(actor.height_m);
  }
  bus_.publish("TRUTH", message);
}

void Witness::watch_actors(const sim::Truth& truth) {
  const double now_s = 1e-6 * static_cast<double>(plant_.now_us());
  BrakeWatch::Moment moment;
  moment.time_us = plant_.now_us();
  moment.T_world_base = geometry::to_se2(truth.T_world_base);
  moment.forward_mps = truth.forward_mps;
  const std::size_t n = record_.turns_us.size();
  moment.sweep_s =
      n < 2 ? 0.0 : 1e-6 * static_cast<double>(record_.turns_us[n - 1] - record_.turns_us[n - 2]);
  for (const sim::Actor& actor : world_.actors) {
    const sim::ActorState state{actor.position(now_s), actor.radius_m, actor.height_m};
    const bool seen = actor.is_there(now_s) && is_visible(state, truth);
    moment.visible.push_back(seen ? std::optional(state) : std::nullopt);
  }
  brake_.see(moment);
}

// By a ray from the mirror to the actor's axis: what is half hidden counts as seen or not by that.
bool Witness::is_visible(const sim::ActorState& actor, const sim::Truth& truth) const {
  const Eigen::Vector3d mirror = truth.T_world_base * Eigen::Vector3d(0.15, 0.0, kMirrorHeightM);
  const double z_m = std::min(mirror.z(), 0.5 * actor.height_m);
  const Eigen::Vector3d way(actor.position.x() - mirror.x(), actor.position.y() - mirror.y(),
                            z_m - mirror.z());
  const double free_m = way.norm() - actor.radius_m;
  return free_m <= 0.0 || !caster_.cast({mirror, way.normalized()}, free_m);
}

}  // namespace nodmap::trial
