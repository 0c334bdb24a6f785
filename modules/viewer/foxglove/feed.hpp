// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "common/node/message_counts.hpp"
#include "common/robot/robot_params.hpp"
#include "modules/viewer/foxglove/assemblers.hpp"
#include "modules/viewer/foxglove/cloud_downsampler.hpp"
#include "modules/viewer/foxglove/pose_views.hpp"
#include "modules/viewer/foxglove/process_feed.hpp"
#include "modules/viewer/foxglove/scene_views.hpp"
#include "modules/viewer/foxglove/stop_state.hpp"
#include "modules/viewer/foxglove/topic_store.hpp"

namespace nodmap::foxglove {

/// How much is kept of clouds and trails, and the robot to draw.
struct FeedParams {
  int max_cloud_points = 2'000'000;
  double cloud_spacing_m = 0.03;
  double trail_spacing_m = 0.1;
  robot::RobotParams robot{};

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer("max_cloud_points", max_cloud_points, {1000, 100'000'000},
              "Number of points of CLOUD kept for clients that connect later; the oldest keyframes "
              "are dropped first.");
    v.number("cloud_spacing_m", cloud_spacing_m, {0.0, 1.0},
             "Spacing of the points of CLOUD: a point this near to one already shown is omitted, "
             "so that memory grows with the size of the building, not with time; 0 shows all.");
    v.number("trail_spacing_m", trail_spacing_m, {0.001, 10.0},
             "Spacing of the poses of trails; the newest 2000 of each trail are kept.");
    robot.describe(v);
  }
};

/// Subscribes to nodmap's channels on a bus and posts what a viewer shows to a topic store. A topic
/// that shows the messages of one channel has its name; `tf/*`, `trail/*`, `scene/*`, `keyframes`
/// and `log` combine several; `stop_state` is what STOP says altogether.
class Feed {
 public:
  /// All three must outlive this object. `counts` counts the messages used, lost and rejected.
  Feed(bus::Bus& bus, TopicStore& store, node::MessageCounts& counts, const FeedParams& params);

  /// Forgets everything collected so far, because a recording starts again.
  void reset();

  /// Adds the commands of the process manager's configuration to the table of commands.
  void set_configured_commands(const procman::Config& config);

 private:
  /// The differences between POSE_2D and POSE_6D.
  struct SlamChannel;

  void subscribe_sensors(bus::Bus& bus);
  void subscribe_odometry(bus::Bus& bus);
  void subscribe_decisions(bus::Bus& bus);
  void subscribe_egomap(bus::Bus& bus, const char* channel);
  void subscribe_slam_pose(bus::Bus& bus, const SlamChannel& slam);
  void subscribe_maps(bus::Bus& bus);
  void subscribe_cloud(bus::Bus& bus);
  /// Whether a message of this sender belongs to the map that is shown; forgets the cloud if the
  /// sender is a 6D SLAM that was started since.
  [[nodiscard]] bool follow_cloud(std::size_t topic, const bus::Sender& sender);
  void forget_cloud(std::size_t topic);
  void subscribe_truth(bus::Bus& bus);

  /// Adds a topic that shows a channel's message field by field; returns the function that posts a
  /// message to it.
  template <class Message>
  [[nodiscard]] auto add_fields_topic(const char* channel);
  /// Adds a topic `scene/NAME`; returns its number.
  [[nodiscard]] std::size_t add_scene_topic(const char* name);

  /// Posts the Json that `make()` returns; calls it when the first reader wants the message.
  template <class Make>
  void post(std::size_t topic, time::Timestamp stamp, Make make, std::size_t weight = 1);
  void post_trail(std::size_t topic, Trail& trail, time::Timestamp stamp,
                  const geometry::SE3& T_frame_base);
  /// Counts a part of a map or cloud; returns the whole if this part completes it.
  template <class Whole>
  [[nodiscard]] std::optional<Whole> take(Assembled<Whole> result, const char* cause);

  TopicStore& store_;
  node::MessageCounts& counts_;
  FeedParams params_;
  Trail odometry_trail_;
  Trail trail_2d_;
  Trail trail_6d_;
  std::optional<bus::Sender> cloud_sender_;         // of CLOUD and POSE_GRAPH_6D
  std::optional<bus::Sender> former_cloud_sender_;  // the one before it
  KeyframePoses keyframes_;
  std::set<std::int64_t> keyframe_ids_;  // of CLOUD, since the map began
  GridAssembler grid_;
  CloudAssembler cloud_;
  CloudDownsampler cloud_downsampler_;
  OctomapAssembler octomap_;
  StopState stop_state_;
  std::optional<ProcessFeed> processes_;  // constructed where its topics are due
  bool body_posted_ = false;
  Eigen::Vector3d p_base_mount_;  // of the newest scan; of the parameters before the first
};

}  // namespace nodmap::foxglove
