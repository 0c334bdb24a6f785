// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/bus/log_player.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"

namespace nodmap::viewer {

using foxglove::Json;

/// A player's state as parameters of the protocol: `playback.position_s`, `playback.duration_s`
/// and `playback.begin_s`, the time stamp at position 0 (both read only), `playback.speed`,
/// `playback.paused`.
[[nodiscard]] Json playback_parameters(const bus::LogPlayer& player);

/// The events in recordings, for marks on the time line: "12.345 stop by WHO", "12.345 fault
/// PROCESS: REASON", "12.345 keyframe NUMBER"; position in seconds, in the order of time, at most
/// 1000 of each kind.
[[nodiscard]] std::vector<std::string> playback_events(
    const std::vector<std::filesystem::path>& logs);

/// The result of setting a parameter.
struct PlaybackChange {
  std::string refusal;  ///< why it was refused; empty if it was set
  bool went_back = false;
};
[[nodiscard]] PlaybackChange set_playback_parameter(bus::LogPlayer& player, const std::string& name,
                                                    const Json& value);

}  // namespace nodmap::viewer
