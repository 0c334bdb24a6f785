// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/foxglove/assemblers.hpp"
#include "common/foxglove/board.hpp"
#include "common/foxglove/cloud_thinner.hpp"
#include "common/foxglove/command_table.hpp"
#include "common/foxglove/message_views.hpp"
#include "common/foxglove/pose_views.hpp"
#include "common/foxglove/scene_views.hpp"
#include "common/node/message_counts.hpp"

namespace nodmap::foxglove {

struct FeedOptions {
  /// Points of CLOUD kept for readers that come later; the oldest keyframes go first.
  std::size_t max_cloud_points = 2'000'000;
  /// A point of CLOUD is left out where one this near has been shown; 0 keeps all.
  double cloud_spacing_m = 0.0;
  double trail_spacing_m = 0.1;  ///< poses of the trails are at least this far apart
};

/// Hears nodmap's channels on a bus and posts what a viewer shows. Topics have the name of their
/// channel where they show its message; `tf/*`, `trail/*`, `scene/*`, `keyframes` and `log` are
/// made from several.
class Feed {
 public:
  /// All three must outlive this object.
  Feed(bus::Bus& bus, Board& board, node::MessageCounts& counts, const FeedOptions& options);

  /// Forgets what was put together so far, as when a recording begins anew.
  void reset();

  /// What the process manager's configuration has, for the table of commands.
  void know_commands(std::vector<CommandTable::Known> commands);

 private:
  struct Topics {
    explicit Topics(Board& board, const FeedOptions& options);
    std::size_t scan, pitch_state, pitch_command, odometry, drive, navigation, pose_2d, pose_6d,
        goal, stop, base_sensors, truth, status, pm_info, obstacle_map, structure_map, map_2d,
        cloud, octomap;
    std::size_t tf_base, tf_map, tf_map_6d, tf_world;
    std::size_t trail_odometry, trail_2d, trail_6d, keyframes;
    std::size_t body, corridor, area_of_interest, goal_mark, people, log;
  };

  template <class Message, class Handler>
  void hear(bus::Bus& bus, const char* channel, Handler handler);
  template <class Message>
  void post_fields(std::size_t topic, const Message& message);
  template <class Make>
  void post(std::size_t topic, std::int64_t utime_us, Make make);
  void post_trail(std::size_t topic, Trail& trail, std::int64_t utime_us,
                  const geometry::SE3& T_frame_base);

  void on_scan(const nodmap::scan_t& message);
  void on_odometry(const nodmap::odometry_t& message);
  void on_pose_2d(const nodmap::pose_t& message);
  void on_pose_6d(const nodmap::pose_t& message);
  void on_egomap(std::size_t topic, const nodmap::egomap_t& message);
  void on_grid(const nodmap::grid_chunk_t& message);
  void on_cloud(const nodmap::cloud_chunk_t& message);
  void on_octomap(const nodmap::octomap_chunk_t& message);
  void on_deputy_info(const procman_lcm::deputy_info_t& message);
  void on_status(const nodmap::status_t& message);
  void on_truth(const nodmap::truth_t& message);
  void hear_sensors(bus::Bus& bus);
  void hear_decisions(bus::Bus& bus);
  void hear_maps(bus::Bus& bus);

  Board& board_;
  node::MessageCounts& counts_;
  Topics topics_;
  Body body_;
  Trail odometry_trail_;
  Trail trail_2d_;
  Trail trail_6d_;
  Trail keyframes_;
  GridAssembler grid_;
  CloudAssembler cloud_;
  CloudThinner cloud_thinner_;
  OctomapAssembler octomap_;
  ProcessTable processes_;
  CommandTable commands_;
  bool body_posted_ = false;
  Eigen::Vector3d p_base_mount_{0.0, 0.0, 0.4};  // until the first scan tells
};

}  // namespace nodmap::foxglove
