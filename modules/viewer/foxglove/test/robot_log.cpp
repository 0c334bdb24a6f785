// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/test/robot_log.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/codec.hpp"
#include "common/bus/event_log.hpp"
#include "modules/viewer/foxglove/test/robot_maps.hpp"
#include "modules/viewer/foxglove/test/robot_messages.hpp"

namespace nodmap::foxglove::test {
namespace {

struct Event {
  std::int64_t utime_us;
  std::string channel;
  std::vector<std::byte> bytes;
};

// Adds a message to the list, which is sorted afterwards.
template <class Message>
void note(std::vector<Event>& events, const std::string& channel, const Message& message) {
  Event event{message.utime, channel, {}};
  bus::encode_into(event.bytes, message);
  events.push_back(std::move(event));
}

void note_fast_channels(std::vector<Event>& events, double duration_s) {
  for (int i = 0; i < static_cast<int>(200.0 * duration_s); ++i) {
    note(events, "PITCH_STATE", pitch_state_at(i / 200.0));
  }
  for (int i = 0; i < static_cast<int>(100.0 * duration_s); ++i) {
    note(events, "ODOMETRY", odometry_at(i / 100.0));
  }
  for (int i = 0; i < static_cast<int>(50.0 * duration_s); ++i) {
    note(events, "TRUTH", truth_at(i / 50.0));
  }
}

void note_scan_channels(std::vector<Event>& events, double duration_s) {
  for (int i = 0; i < static_cast<int>(75.0 * duration_s); ++i) {
    const double time_s = i / 75.0;
    note(events, "SCAN", scan_at(time_s));
    note(events, "OBSTACLE_MAP", egomap_at(time_s));
    note(events, "STRUCTURE_MAP", egomap_at(time_s));
    note(events, "NAVIGATION", navigation_at(time_s));
    note(events, "DRIVE", drive_at(time_s));
    note(events, "PITCH_COMMAND", pitch_command_at(time_s));
  }
}

void note_slow_channels(std::vector<Event>& events, const RobotLog& settings) {
  note(events, "GOAL", goal());
  note(events, "PATH", path());
  note(events, "TRACKS", tracks());
  note(events, "LOCAL_MAP", local_map());
  note(events, "EXPLORATION", exploration());
  note(events, "POSE_GRAPH", pose_graph());
  nodmap::pose_graph_6d_t graph = pose_graph_6d();
  graph.position_m = {{0.0, 0.0, 0.0}, {kSpeedMps, 0.0, 0.0}};  // where CLOUD has them
  note(events, "POSE_GRAPH_6D", graph);
  note(events, "STOP", stop());
  for (int i = 0; i < static_cast<int>(20.0 * settings.duration_s); ++i) {
    note(events, "BASE_SENSORS", base_sensors_at(i / 20.0));
  }
  for (int i = 0; i < static_cast<int>(5.0 * settings.duration_s); ++i) {
    note(events, "POSE_2D", pose_at(i / 5.0));
  }
  for (int i = 0; i < static_cast<int>(settings.duration_s); ++i) {
    note(events, "STATUS", status_at(i));
    note(events, "PM_INFO", deputy_info_at(i));
    for (const auto& chunk : octomap_at(i, i)) {
      note(events, "OCTOMAP", chunk);
    }
    for (const auto& tile : map_at(i, i)) {
      note(events, "MAP_2D", tile);
    }
  }
  for (int i = 0; i * settings.keyframe_every_s < settings.duration_s; ++i) {
    const double time_s = i * settings.keyframe_every_s;
    note(events, "POSE_6D", pose_at(time_s));
    for (const auto& chunk : keyframe_at(time_s, i, settings.points_per_keyframe)) {
      note(events, "CLOUD", chunk);
    }
  }
}

}  // namespace

void write_robot_log(const std::filesystem::path& file, const RobotLog& settings) {
  std::vector<Event> events;
  note_fast_channels(events, settings.duration_s);
  note_scan_channels(events, settings.duration_s);
  note_slow_channels(events, settings);
  std::ranges::stable_sort(events, {}, &Event::utime_us);
  bus::LogWriter writer(file);
  for (const Event& event : events) {
    if (!writer.write(event.utime_us, event.channel, event.bytes)) {
      throw std::runtime_error(file.string() + ": cannot write");
    }
  }
}

}  // namespace nodmap::foxglove::test
