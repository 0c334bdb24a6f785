// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "common/bus/followed_sender.hpp"
#include "common/bus/sender_watch.hpp"
#include "common/node/node.hpp"
#include "common/node/sensor_input.hpp"
#include "modules/pitch_controller/pitch_controller.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/pitch_state_t.hpp"

namespace nodmap::pitch_controller {

/// Subscribes to ODOMETRY and PITCH_STATE, and publishes PITCH_COMMAND. Either input triggers
/// commands: when one input stops, the other still triggers commands, with a speed bound of 0. When
/// both stop, no PITCH_COMMAND is published, and the navigator stops the robot because the last one
/// is too old.
class PitchControllerNode final : public node::Node {
 public:
  using Params = PitchControllerParams;

  PitchControllerNode(node::Context& context, const Params& params);

  void write_results(const std::filesystem::path& /*dir*/) override {}
  [[nodiscard]] nlohmann::json metrics() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  void on_odometry(const nodmap::odometry_t& message);
  void on_pitch_state(const nodmap::pitch_state_t& message);
  void on_navigation(const nodmap::navigation_t& message);
  void decide(time::Timestamp now);

  node::Context& context_;
  Params params_;
  node::SensorInput input_;
  bus::FollowedSender pitch_state_sender_{bus::SenderWatch::kSilence};
  bus::FollowedSender navigation_sender_{bus::SenderWatch::kSilence};
  node::SequenceCounter pitch_states_;
  PitchController controller_;
  InhibitReason inhibited_ = InhibitReason::kNone;
  bool pitch_is_measured_ = true;
  std::int64_t commands_ = 0;
  std::int64_t commands_inhibited_ = 0;
  double fastest_allowed_mps_ = 0.0;
};

}  // namespace nodmap::pitch_controller
