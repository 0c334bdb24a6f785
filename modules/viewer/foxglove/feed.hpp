// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "common/node/message_counts.hpp"
#include "modules/viewer/foxglove/assemblers.hpp"
#include "modules/viewer/foxglove/cloud_downsampler.hpp"
#include "modules/viewer/foxglove/pose_views.hpp"
#include "modules/viewer/foxglove/process_tables.hpp"
#include "modules/viewer/foxglove/scene_views.hpp"
#include "modules/viewer/foxglove/topic_store.hpp"

namespace nodmap::foxglove {

/// What is kept of clouds and trails.
struct FeedParams {
  int max_cloud_points = 2'000'000;
  double cloud_spacing_m = 0.03;
  double trail_spacing_m = 0.1;

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("max_cloud_points", max_cloud_points, {1000, 100'000'000},
              "Points of CLOUD kept for clients that come later; the oldest keyframes go first.");
    v.number(
        "cloud_spacing_m", cloud_spacing_m, {0.0, 1.0},
        "A point of CLOUD is left out where one this near has been shown, so that memory grows "
        "with the building, not with the time; 0 shows all.");
    v.number("trail_spacing_m", trail_spacing_m, {0.001, 10.0},
             "Poses of the trails are at least this far apart; the newest 2000 of each are kept.");
  }
};

/// Subscribes to nodmap's channels on a bus and puts what a viewer shows into a topic store. Topics
/// have the name of their channel where they show its message; `tf/*`, `trail/*`, `scene/*`,
/// `keyframes` and `log` are made from several.
class Feed {
 public:
  /// All three must outlive this object. `counts` counts the messages used, lost and rejected.
  Feed(bus::Bus& bus, TopicStore& store, node::MessageCounts& counts, const FeedParams& params);

  /// Forgets what was put together so far, as when a recording begins anew.
  void reset();

  /// Lists the commands of the process manager's configuration in the table of commands.
  void set_configured_commands(const procman::Config& config);

 private:
  /// What POSE_2D and POSE_6D differ in.
  struct SlamChannel;

  void subscribe_sensors(bus::Bus& bus);
  void subscribe_odometry(bus::Bus& bus);
  void subscribe_decisions(bus::Bus& bus);
  void subscribe_egomap(bus::Bus& bus, const char* channel);
  void subscribe_slam_pose(bus::Bus& bus, const SlamChannel& slam);
  void subscribe_maps(bus::Bus& bus);
  void subscribe_cloud(bus::Bus& bus);
  void take_keyframe_poses(const nodmap::pose_graph_6d_t& graph);
  void subscribe_processes(bus::Bus& bus);
  void subscribe_truth(bus::Bus& bus);

  /// Adds a topic that shows a channel's message field by field. Returns what posts a message
  /// there.
  template <class Message>
  [[nodiscard]] auto add_fields_topic(const char* channel);
  /// Adds a topic `scene/NAME`; its number.
  [[nodiscard]] std::size_t add_scene_topic(const char* name);

  /// Posts what `make()` returns, a Json, when the first reader wants it.
  template <class Make>
  void post(std::size_t topic, time::Timestamp stamp, Make make, std::size_t weight = 1);
  void post_trail(std::size_t topic, Trail& trail, time::Timestamp stamp,
                  const geometry::SE3& T_frame_base);
  /// Counts a part of a map or cloud; the whole if this part made it complete.
  template <class Whole>
  [[nodiscard]] std::optional<Whole> take(Assembled<Whole> result, const char* cause);

  TopicStore& store_;
  node::MessageCounts& counts_;
  FeedParams params_;
  Body body_;
  Trail odometry_trail_;
  Trail trail_2d_;
  Trail trail_6d_;
  KeyframePoses keyframes_;
  GridAssembler grid_;
  CloudAssembler cloud_;
  CloudDownsampler cloud_downsampler_;
  OctomapAssembler octomap_;
  ProcessTable processes_;
  CommandTable commands_;
  std::size_t commands_topic_ = 0;
  bool body_posted_ = false;
  Eigen::Vector3d p_base_mount_{0.0, 0.0, 0.4};  // until the first scan tells
};

}  // namespace nodmap::foxglove
