// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/ground_truth_monitor.hpp"

#include <algorithm>
#include <utility>

#include "common/node/messages.hpp"
#include "modules/navigator/reason.hpp"
#include "nodmap/drive_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "sim/truth_message.hpp"
#include "tools/trial/record.hpp"

namespace nodmap::trial {
namespace {

constexpr time::Duration kRecordPeriod = 10ms;
constexpr time::Duration kTruthPeriod = 20ms;

}  // namespace

GroundTruthMonitor::GroundTruthMonitor(const sim::World& world, const sim::RobotModel& model,
                                       bus::LoopNetwork& network, BrakeLatencyMonitor brake_latency,
                                       const Eigen::Vector3d& p_base_mirror,
                                       const slam6d::TraceParams& map)
    : world_(world),
      model_(model),
      caster_(world),
      bus_(network),
      brake_latency_(std::move(brake_latency)),
      p_base_mirror_(p_base_mirror),
      observed_voxels_(map) {
  subscribe();
}

void GroundTruthMonitor::subscribe() {
  bus_.subscribe<nodmap::scan_t>("SCAN",
                                 [this](const nodmap::scan_t& message) { on_scan(message); });
  bus_.subscribe<nodmap::drive_t>("DRIVE", [this](const nodmap::drive_t& message) {
    brake_latency_.add_drive_command(model_.now(), message.drive_seq, message.forward_mps);
    if (!record_.drives_mps.empty() && message.drive_seq <= record_.drives_mps.rbegin()->first) {
      record_.drives_mps.clear();  // a navigator that was restarted counts from 0
    }
    record_.drives_mps[message.drive_seq] = message.forward_mps;
  });
  bus_.subscribe<nodmap::pitch_state_t>(
      "PITCH_STATE", [this](const nodmap::pitch_state_t& message) { on_pitch_state(message); });
  bus_.subscribe<nodmap::odometry_t>("ODOMETRY", [this](const nodmap::odometry_t& message) {
    if (const auto T_odom_base = node::read_odometry(message)) {
      record_.odometry.push_back({time::from_utime(message.utime), *T_odom_base});
    }
  });
  bus_.subscribe<nodmap::navigation_t>("NAVIGATION", [this](const nodmap::navigation_t& message) {
    if (message.behaviour == nodmap::navigation_t::ARRIVED &&
        std::exchange(reached_goal_utime_, message.goal_utime) != message.goal_utime) {
      record_.arrivals.push_back(model_.now());
    }
    record_refusal(message);
    const bool slips = message.reason == navigator::to_text(navigator::Why::kTouches);
    if (slips && !reports_slip_) {
      record_.slips.push_back(model_.now());
    }
    reports_slip_ = slips;
  });
}

// PATH says the same, but another listener would change the delays of the messages.
void GroundTruthMonitor::record_refusal(const nodmap::navigation_t& message) {
  using navigator::Why;
  const auto is_reason = [&message](Why why) { return message.reason == navigator::to_text(why); };
  if (message.behaviour == nodmap::navigation_t::STEER ||
      message.behaviour == nodmap::navigation_t::ARRIVED) {
    record_.refused.reset();
  } else if (!record_.refused && (is_reason(Why::kNoPath) || is_reason(Why::kNoPathLooks))) {
    record_.refused = model_.now();
  }
}

void GroundTruthMonitor::on_scan(const nodmap::scan_t& message) {
  record_.started = record_.started.value_or(model_.now());
  scan::Scan scan;
  if (!node::read_scan(message, scan)) {
    return;
  }
  const auto T_world_first = T_world_base_.at(scan.stamp);
  const auto T_world_last = T_world_base_.at(scan.last_stamp());
  if (T_world_first && T_world_last) {
    const geometry::SE3 T_map_world = geometry::to_se3(world_.T_world_start.inverse());
    observed_voxels_.add(scan, T_map_world * *T_world_first, T_map_world * *T_world_last);
  }
}

void GroundTruthMonitor::on_pitch_state(const nodmap::pitch_state_t& message) {
  if (sweep_ && message.sweep_count < *sweep_) {
    reversed_.reset();  // the driver has been restarted
  } else if (sweep_ && message.sweep_count > *sweep_) {
    const time::Timestamp stamp = time::from_utime(message.utime);
    if (reversed_) {
      record_.sweep_times_s.push_back(time::seconds(stamp - *reversed_));
    }
    reversed_ = stamp;
  }
  sweep_ = message.sweep_count;
}

void GroundTruthMonitor::update() {
  const time::SteadyTime now = model_.now();
  const bool recorded = now.time_since_epoch() % kRecordPeriod == 0s;
  if (!recorded && world_.actors.empty()) {
    return;
  }
  const sim::GroundTruth truth = model_.ground_truth();
  if (recorded) {
    record_.truth.push_back({now, truth.T_world_base, truth.forward_mps, truth.yaw_rate_rad_s,
                             truth.clearance_m, truth.person_clearance_m, truth.contacts});
    record_progress(truth.T_world_base.translation().head<2>());
    T_world_base_.add(stamp_at(now), truth.T_world_base);
  }
  if (now.time_since_epoch() % kTruthPeriod == 0s) {
    publish(truth);
  }
  if (!world_.actors.empty()) {
    update_brake_latency(truth);
  }
}

// Records the first motion, and the arrival by the rules of a task that does not depend on the
// robot's report.
void GroundTruthMonitor::record_progress(const Eigen::Vector2d& position) {
  constexpr double kMovedM = 0.1;
  if (!record_.moved && (position - world_.T_world_start.translation()).norm() >= kMovedM) {
    record_.moved = model_.now();
  }
  const std::optional<double>& radius_m = world_.task.arrival_radius_m;
  if (radius_m && !record_.reached && !world_.goals.empty() &&
      record_.arrivals.size() + 1 >= world_.goals.size() &&
      (position - world_.goals.back()).norm() <= *radius_m) {
    record_.reached = model_.now();
  }
}

void GroundTruthMonitor::publish(const sim::GroundTruth& truth) {
  nodmap::truth_t message = sim::write_truth(truth, stamp_at(model_.now()));
  message.truth_seq = truth_seq_++;
  bus_.publish("TRUTH", message);
}

void GroundTruthMonitor::update_brake_latency(const sim::GroundTruth& truth) {
  BrakeLatencyMonitor::State state;
  state.instant = model_.now();
  state.T_world_base = geometry::to_se2(truth.T_world_base);
  state.forward_mps = truth.forward_mps;
  state.sweep_s = record_.sweep_times_s.empty() ? 0.0 : record_.sweep_times_s.back();
  state.actors.resize(world_.actors.size());
  for (const sim::ActorState& actor : truth.actors) {
    state.actors[actor.actor] = {actor, is_visible(actor, truth)};
  }
  brake_latency_.update(state);
}

// A ray from the mirror to the actor's axis decides, also for partly hidden actors.
bool GroundTruthMonitor::is_visible(const sim::ActorState& actor,
                                    const sim::GroundTruth& truth) const {
  const Eigen::Vector3d mirror = truth.T_world_base * p_base_mirror_;
  const double z_m = std::min(mirror.z(), 0.5 * actor.height_m);
  const Eigen::Vector3d to_actor(actor.position.x() - mirror.x(), actor.position.y() - mirror.y(),
                                 z_m - mirror.z());
  const double distance_m = to_actor.norm() - actor.radius_m;
  return distance_m <= 0.0 || !caster_.cast({mirror, to_actor.normalized()}, distance_m);
}

}  // namespace nodmap::trial
