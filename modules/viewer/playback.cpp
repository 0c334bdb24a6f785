// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/playback.hpp"

#include <cmath>
#include <iomanip>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <sstream>
#include <utility>

#include "common/bus/codec.hpp"
#include "common/geometry/time.hpp"
#include "common/node/messages.hpp"
#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::viewer {
namespace {

// Longer than any recording, and still exact to the microsecond.
constexpr double kMaxPositionS = 1e9;
constexpr std::size_t kMaxEventsOfAKind = 1000;

// Finds the messages that report an event, which is a change of state.
class EventFinder {
 public:
  // Describes what happened by this message; empty if nothing.
  std::string look_at(const std::string& channel, std::span<const std::byte> bytes) {
    if (channel == "STOP" && bus::decode_into(stop_, bytes)) {
      const bool was_stopped = std::exchange(is_stopped_, stop_.is_stopped != 0);
      const bool is_new = is_stopped_ && !was_stopped;
      return is_new ? "stop by " + node::read_name(stop_.requested_by) : std::string();
    }
    if (channel == "STATUS" && bus::decode_into(status_, bytes)) {
      return status_event();
    }
    if (channel == "CLOUD" && bus::decode_into(chunk_, bytes)) {
      const bool is_new = chunk_.keyframe_id != std::exchange(keyframe_, chunk_.keyframe_id);
      return is_new ? "keyframe " + std::to_string(chunk_.keyframe_id) : std::string();
    }
    return {};
  }

 private:
  // Describes a process that has just FAILED.
  std::string status_event() {
    const bool fails = status_.health == nodmap::status_t::FAILED;
    const bool is_new = fails && !failed_.contains(status_.process_name);
    fails ? (void)failed_.insert(status_.process_name) : (void)failed_.erase(status_.process_name);
    return is_new ? "fault " + node::read_name(status_.process_name) + ": " +
                        node::read_name(status_.health_reason)
                  : std::string();
  }

  nodmap::stop_t stop_{};
  nodmap::status_t status_{};
  nodmap::cloud_chunk_t chunk_{};
  bool is_stopped_ = false;
  std::set<std::string> failed_;
  std::int64_t keyframe_ = -1;
};

}  // namespace

Json playback_parameters(const bus::LogPlayer& player) {
  const auto parameter = [](const char* name, Json value) -> Json {
    return {{"name", name}, {"value", std::move(value)}};
  };
  return Json::array(
      {parameter("playback.position_s", time::seconds(player.position())),
       parameter("playback.duration_s", time::seconds(player.duration())),
       parameter("playback.begin_s",
                 time::seconds((player.now() - player.position()).time_since_epoch())),
       parameter("playback.speed", player.speed()), parameter("playback.paused", player.paused())});
}

std::vector<std::string> playback_events(const std::vector<std::filesystem::path>& logs) {
  bus::LogPlayer player(logs);
  const time::Timestamp begin = player.now();
  EventFinder finder;
  std::map<char, std::size_t> counts;  // by the first letter of the kind of event
  std::vector<std::string> lines;
  for (const std::string channel : {"STOP", "STATUS", "CLOUD"}) {
    player.subscribe_bytes(channel, [&, channel](std::span<const std::byte> bytes) {
      const std::string what = finder.look_at(channel, bytes);
      if (!what.empty() && ++counts[what.front()] <= kMaxEventsOfAKind) {
        std::ostringstream line;
        line << std::fixed << std::setprecision(3) << time::seconds(player.event_time() - begin)
             << ' ' << what;
        lines.push_back(line.str());
      }
    });
  }
  (void)player.seek(player.duration());
  player.catch_up(std::numeric_limits<std::int64_t>::max());
  return lines;
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
    return {.refusal = {}, .went_back = player.seek(time::from_seconds(value.get<double>()))};
  }
  return {.refusal = "unknown parameter or invalid value", .went_back = false};
}

}  // namespace nodmap::viewer
