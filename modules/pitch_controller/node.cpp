// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/node.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/node/messages.hpp"
#include "nodmap/pitch_command_t.hpp"

namespace nodmap::pitch_controller {
namespace {

bool is_plausible(const nodmap::navigation_t& message) {
  return time::is_plausible(time::from_utime(message.utime)) && message.clear_distance_m >= 0.0 &&
         std::isfinite(message.max_forward_mps) && message.max_forward_mps >= 0.0;
}

OnArc on_arc(std::int8_t behaviour) {
  switch (behaviour) {
    case nodmap::navigation_t::STEER:
      return OnArc::kDrives;
    case nodmap::navigation_t::BRAKE:
      return OnArc::kSlowed;
    default:
      return OnArc::kElse;
  }
}

const char* describe(InhibitReason reason) {
  switch (reason) {
    case InhibitReason::kNone:
      return "";
    case InhibitReason::kNoOdometry:
      return "ODOMETRY is missing or stale: driving is inhibited.";
    case InhibitReason::kNoPitch:
      return "PITCH_STATE is missing or stale: driving is inhibited.";
    case InhibitReason::kStalled:
      return "The pitch servo is stalled: driving is inhibited.";
    case InhibitReason::kNotNodding:
      return "The head is not nodding, or has not completed two sweeps yet: driving is inhibited.";
    case InhibitReason::kPitchGaps:
      return "PITCH_STATE comes more than 60 ms apart, so no sweep can be measured: driving is "
             "inhibited.";
    case InhibitReason::kNotLevel:
      return "The laser is not level yet: driving is inhibited.";
  }
  return "";
}

}  // namespace

PitchControllerNode::PitchControllerNode(node::Context& context, const Params& params)
    : context_(context),
      params_(params),
      input_(context.counts, &context.bus),
      controller_(params) {
  context.bus.subscribe<nodmap::odometry_t>(
      "ODOMETRY", [this](const nodmap::odometry_t& message) { on_odometry(message); });
  context.bus.subscribe<nodmap::pitch_state_t>(
      "PITCH_STATE", [this](const nodmap::pitch_state_t& message) { on_pitch_state(message); });
  if (params.follows_path) {
    context.bus.subscribe<nodmap::navigation_t>(
        "NAVIGATION", [this](const nodmap::navigation_t& message) { on_navigation(message); });
  }
}

void PitchControllerNode::on_odometry(const nodmap::odometry_t& message) {
  if (!input_.read(message)) {
    return;
  }
  context_.counts.use();
  controller_.add_speed(time::from_utime(message.utime), message.forward_mps);
  decide(time::from_utime(message.utime));
}

void PitchControllerNode::on_pitch_state(const nodmap::pitch_state_t& message) {
  const bus::Origin& origin = context_.bus.origin();
  if (!pitch_state_sender_.follow(origin.sender, origin.arrived)) {
    context_.counts.reject("other_sender_of_pitch_state");
    return;
  }
  context_.counts.lose(pitch_states_.lost_before(message.state_seq));
  if (!node::is_plausible(message)) {
    context_.counts.reject("implausible_pitch_state");
    return;
  }
  context_.counts.use();
  pitch_is_measured_ = message.pitch_is_measured != 0;
  controller_.add_pitch({time::from_utime(message.utime), message.pitch_rad,
                         message.pitch_rate_rad_s, message.sweep_count, message.is_stalled != 0});
  decide(time::from_utime(message.utime));
}

// Decides nothing by itself: without ODOMETRY and PITCH_STATE there must be no command.
void PitchControllerNode::on_navigation(const nodmap::navigation_t& message) {
  const bus::Origin& origin = context_.bus.origin();
  if (!navigation_sender_.follow(origin.sender, origin.arrived)) {
    context_.counts.reject("other_sender_of_navigation");
    return;
  }
  if (!is_plausible(message)) {
    context_.counts.reject("implausible_navigation");
    return;
  }
  context_.counts.use();
  controller_.add_chosen_arc({time::from_utime(message.utime), on_arc(message.behaviour),
                              message.clear_distance_m, message.max_forward_mps});
}

void PitchControllerNode::decide(time::Timestamp now) {
  const auto decision = controller_.decide(now);
  if (!decision) {
    return;
  }
  inhibited_ = decision->inhibited;
  nodmap::pitch_command_t message{};
  message.utime = time::to_utime(decision->stamp);
  message.command_seq = commands_++;
  message.pitch_min_rad = decision->sweep.min_rad;
  message.pitch_max_rad = decision->sweep.max_rad;
  message.sweep_s = decision->sweep_s;
  message.max_forward_mps = decision->max_forward_mps;
  context_.bus.publish("PITCH_COMMAND", message);
  commands_inhibited_ += decision->max_forward_mps > 0.0 ? 0 : 1;
  fastest_allowed_mps_ = std::max(fastest_allowed_mps_, decision->max_forward_mps);
}

nlohmann::json PitchControllerNode::metrics() const {
  const SweepCounts& sweeps = controller_.sweep_counts();
  return {{"commands", commands_},
          {"commands_inhibited", commands_inhibited_},
          {"fastest_allowed_mps", fastest_allowed_mps_},
          {"sweeps", sweeps.complete},
          {"sweeps_below_15_scans", sweeps.too_short},
          {"sweeps_above_500_scans", sweeps.too_long}};
}

node::Health PitchControllerNode::health() const {
  using node::HealthState;
  if (inhibited_ != InhibitReason::kNone) {
    return {HealthState::kDegraded, describe(inhibited_)};
  }
  if (params_.mode == Mode::kFixed) {
    return {HealthState::kDegraded,
            "The laser is held level: obstacles above or below its plane are not seen."};
  }
  if (!pitch_is_measured_) {
    return {HealthState::kDegraded,
            "The pitch is not measured: a servo that stalls would not be noticed."};
  }
  return {};
}

}  // namespace nodmap::pitch_controller
