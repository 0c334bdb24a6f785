// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/playback.hpp"

#include <cmath>

namespace nodmap::viewer {
namespace {

/// Far beyond any recording, and still exact in microseconds.
constexpr double kMaxPositionS = 1e9;

}  // namespace

Json playback_parameters(const bus::LogPlayer& player) {
  const auto parameter = [](const char* name, Json value) -> Json {
    return {{"name", name}, {"value", std::move(value)}};
  };
  return Json::array(
      {parameter("playback.position_s", 1e-6 * static_cast<double>(player.position_us())),
       parameter("playback.duration_s", 1e-6 * static_cast<double>(player.duration_us())),
       parameter("playback.begin_s",
                 1e-6 * static_cast<double>(player.utime_us() - player.position_us())),
       parameter("playback.speed", player.speed()), parameter("playback.paused", player.paused())});
}

PlaybackChange set_playback_parameter(bus::LogPlayer& player, const std::string& name,
                                      const Json& value) {
  if (name == "playback.paused" && value.is_boolean()) {
    player.set_paused(value.get<bool>());
    return {};
  }
  if (name == "playback.speed" && value.is_number()) {
    player.set_speed(value.get<double>());
    return {};
  }
  if (name == "playback.position_s" && value.is_number() &&
      std::abs(value.get<double>()) < kMaxPositionS) {
    return {.refusal = {}, .went_back = player.seek(std::llround(1e6 * value.get<double>()))};
  }
  return {.refusal = "no such parameter, or not such a value", .went_back = false};
}

}  // namespace nodmap::viewer
