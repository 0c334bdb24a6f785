// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/bus/log_player.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"

namespace nodmap::viewer {

using foxglove::Json;

/// A player's state as parameters of the protocol: `playback.position_s`, `playback.duration_s`
/// and `playback.begin_s`, the time stamp at position 0 (both read only), `playback.speed`,
/// `playback.paused`.
[[nodiscard]] Json playback_parameters(const bus::LogPlayer& player);

/// What setting a parameter did.
struct PlaybackChange {
  std::string refusal;  ///< why not; empty: done
  bool went_back = false;
};
[[nodiscard]] PlaybackChange set_playback_parameter(bus::LogPlayer& player, const std::string& name,
                                                    const Json& value);

}  // namespace nodmap::viewer
