// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "modules/viewer/foxglove.hpp"
#include "modules/viewer/log_player.hpp"

namespace nodmap::viewer {

/// A player's state as parameters of the protocol: `playback.position_s`, `playback.duration_s`
/// (read only), `playback.speed`, `playback.paused`.
[[nodiscard]] Json playback_parameters(const LogPlayer& player);

/// What setting a parameter did.
struct PlaybackChange {
  std::string refusal;  ///< why not; empty: done
  bool went_back = false;
};
[[nodiscard]] PlaybackChange set_playback_parameter(LogPlayer& player, const std::string& name,
                                                    const Json& value);

}  // namespace nodmap::viewer
