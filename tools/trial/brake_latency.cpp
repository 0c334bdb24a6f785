// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/brake_latency.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::trial {
namespace {

// Whether a disc touches the rectangle x in [0, length] from the front, |y| <= half_width.
bool touches(const sim::ActorState& actor, const geometry::SE2& T_world_base, double front_m,
             double length_m, double half_width_m) {
  const Eigen::Vector2d p = T_world_base.inverse() * actor.position;
  const double dx = p.x() - std::clamp(p.x(), front_m, front_m + length_m);
  const double dy = p.y() - std::clamp(p.y(), -half_width_m, half_width_m);
  return std::hypot(dx, dy) <= actor.radius_m;
}

bool brakes(double drive_mps, double speed_mps) {
  return drive_mps <= speed_mps - std::max(0.1, 0.1 * speed_mps);
}

}  // namespace

double StoppingZone::length_m(double forward_mps, double sweep_s) const {
  return braking.required_distance_m(std::max(0.0, forward_mps), detection.reaction_s(sweep_s));
}

void BrakeLatencyMonitor::update(const State& state) {
  actors_.resize(state.actors.size());
  const double length_m = zone_.length_m(state.forward_mps, state.sweep_s);
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    TrackedActor& tracked = actors_[i];
    const std::optional<Actor>& actor = state.actors[i];
    // A robot that slows down a little does not make the obstacle new again.
    const double reach_m = tracked.in_zone ? std::max(length_m, tracked.reach_m) : length_m;
    const bool now = actor && (tracked.in_zone || actor->is_visible) &&
                     touches(actor->state, state.T_world_base, zone_.footprint.half_length_m,
                             reach_m, zone_.footprint.half_width_m);
    // A robot that is told to slow down for something else has not yet reacted to this obstacle.
    const double speed_mps = std::min(state.forward_mps, drive_mps_);
    if (now && !tracked.in_zone && speed_mps >= kMinSpeedMps) {
      tracked.open_event = BrakeEvent{state.instant, speed_mps, state.sweep_s, std::nullopt};
    } else if (!now && tracked.open_event) {
      ++num_evaded_;
      tracked.open_event.reset();
    }
    tracked.in_zone = now;
    tracked.reach_m = reach_m;
  }
}

void BrakeLatencyMonitor::add_drive_command(time::SteadyTime received, std::int64_t drive_seq,
                                            double forward_mps) {
  drive_mps_ = forward_mps;
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    std::optional<BrakeEvent>& event = actors_[i].open_event;
    if (!event || received <= event->started) {
      continue;
    }
    const double anyway_mps = undisturbed_mps(i, drive_seq).value_or(event->speed_mps);
    if (anyway_mps < kMinSpeedMps && received <= event->started + event->limit()) {
      ++num_masked_;
      event.reset();
    } else if (brakes(forward_mps, std::min(event->speed_mps, anyway_mps))) {
      event->answered = received;
      answered_.push_back(*event);
      event.reset();
    }
  }
}

std::optional<double> BrakeLatencyMonitor::undisturbed_mps(std::size_t actor,
                                                           std::int64_t drive_seq) const {
  const auto drive = undisturbed_.drives_mps.find(drive_seq);
  return actor == undisturbed_.actor && drive != undisturbed_.drives_mps.end()
             ? std::optional(drive->second)
             : std::nullopt;
}

std::vector<BrakeEvent> BrakeLatencyMonitor::events() const {
  std::vector<BrakeEvent> events = answered_;
  std::ranges::stable_sort(
      events, [](const BrakeEvent& a, const BrakeEvent& b) { return a.started < b.started; });
  for (const TrackedActor& tracked : actors_) {
    if (tracked.open_event) {
      events.push_back(*tracked.open_event);
    }
  }
  return events;
}

}  // namespace nodmap::trial
