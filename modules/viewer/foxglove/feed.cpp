// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/feed.hpp"

#include <string>
#include <utility>

#include "common/node/messages.hpp"
#include "modules/viewer/foxglove/sensor_views.hpp"
#include "nodmap/base_sensors_t.hpp"
#include "nodmap/drive_t.hpp"
#include "nodmap/json_messages.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/scan_t.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::foxglove {
namespace {

constexpr const char* kTransform = "foxglove.FrameTransform";
constexpr const char* kPoses = "foxglove.PosesInFrame";
constexpr const char* kPointCloud = "foxglove.PointCloud";

template <class Message, class Handler>
void subscribe(bus::Bus& bus, const char* channel, Handler handler) {
  bus.subscribe<Message>(channel, std::move(handler), kFeedQueue);
}

std::size_t max_cloud_points(const FeedParams& params) {
  return static_cast<std::size_t>(params.max_cloud_points);
}

bool have_same_lengths(const nodmap::egomap_t& map) {
  const auto bins = static_cast<std::size_t>(map.num_bins);
  return map.distance_m.size() == bins && map.point_x_m.size() == bins &&
         map.point_y_m.size() == bins && map.point_z_m.size() == bins && map.age_s.size() == bins;
}

}  // namespace

struct Feed::SlamChannel {
  const char* channel;
  const char* frame_topic;
  const char* trail_topic;
  Trail& trail;
  Json (*frame)(time::Timestamp stamp, const geometry::SE3& T_map_odom);
};

Feed::Feed(bus::Bus& bus, TopicStore& store, node::MessageCounts& counts, const FeedParams& params)
    : store_(store),
      counts_(counts),
      params_(params),
      odometry_trail_(frames::kOdom, params.trail_spacing_m),
      trail_2d_(frames::kMap, params.trail_spacing_m),
      trail_6d_(frames::kMap6d, params.trail_spacing_m),
      cloud_downsampler_(params.cloud_spacing_m, max_cloud_points(params)),
      p_base_mount_(params.robot.mount.x_m, params.robot.mount.y_m, params.robot.mount.z_m) {
  subscribe_sensors(bus);
  subscribe_odometry(bus);
  subscribe_decisions(bus);
  subscribe_egomap(bus, "OBSTACLE_MAP");
  subscribe_egomap(bus, "STRUCTURE_MAP");
  subscribe_slam_pose(bus, {.channel = "POSE_2D",
                            .frame_topic = "tf/map",
                            .trail_topic = "trail/2d",
                            .trail = trail_2d_,
                            .frame = [](time::Timestamp stamp, const geometry::SE3& T_map_odom) {
                              return frame_transform(stamp, frames::kMap, frames::kOdom,
                                                     T_map_odom);
                            }});
  // Inverted, because a frame has one parent, and that of odom is map.
  subscribe_slam_pose(bus, {.channel = "POSE_6D",
                            .frame_topic = "tf/map_6d",
                            .trail_topic = "trail/6d",
                            .trail = trail_6d_,
                            .frame = [](time::Timestamp stamp, const geometry::SE3& T_map_odom) {
                              return frame_transform(stamp, frames::kOdom, frames::kMap6d,
                                                     T_map_odom.inverse());
                            }});
  subscribe_maps(bus);
  subscribe_cloud(bus);
  processes_.emplace(bus, store, counts);
  subscribe_truth(bus);
}

void Feed::reset() {
  for (Trail* trail : {&odometry_trail_, &trail_2d_, &trail_6d_}) {
    trail->clear();
  }
  keyframes_.clear();
  keyframe_ids_.clear();
  grid_ = {};
  cloud_ = {};
  cloud_downsampler_.clear();
  body_posted_ = false;
  octomap_ = {};
  stop_state_ = {};
  processes_->reset();
}

void Feed::set_configured_commands(const procman::Config& config) {
  processes_->set_configured_commands(config);
}

template <class Make>
void Feed::post(std::size_t topic, time::Timestamp stamp, Make make, std::size_t weight) {
  store_.post(
      topic, stamp, [make = std::move(make)] { return to_text(make()); }, weight);
}

template <class Message>
auto Feed::add_fields_topic(const char* channel) {
  const std::size_t topic = store_.add({channel, JsonMessage<Message>::kName});
  return [this, topic](const Message& message) {
    counts_.use();
    post(topic, node::stamp_of(message),
         [message] { return JsonMessage<Message>::fields(message); });
  };
}

std::size_t Feed::add_scene_topic(const char* name) {
  return store_.add({std::string("scene/") + name, "foxglove.SceneUpdate"});
}

void Feed::post_trail(std::size_t topic, Trail& trail, time::Timestamp stamp,
                      const geometry::SE3& T_frame_base) {
  trail.add(stamp, T_frame_base);
  if (trail.take_turn(stamp)) {
    // By reference: the trail outlives the readers of the store.
    post(topic, stamp, [&trail] { return trail.poses_in_frame(); });
  }
}

template <class Whole>
std::optional<Whole> Feed::take(Assembled<Whole> result, const char* cause) {
  if (result.refused) {
    counts_.reject(cause);
    return std::nullopt;
  }
  counts_.use();
  counts_.lose(result.lost ? 1 : 0);
  return std::move(result.whole);
}

void Feed::subscribe_sensors(bus::Bus& bus) {
  const std::size_t scan_topic = store_.add({"SCAN", "foxglove.LaserScan"});
  subscribe<nodmap::scan_t>(bus, "SCAN", [this, scan_topic](const auto& message) {
    scan::Scan scan;
    if (!node::read_scan(message, scan)) {
      counts_.reject("scan_not_plausible");
      return;
    }
    counts_.use();
    p_base_mount_ = scan.T_base_mount.translation();
    post(scan_topic, node::stamp_of(message),
         [scan = std::move(scan)] { return laser_scan(scan); });
  });
  subscribe<nodmap::pitch_state_t>(bus, "PITCH_STATE",
                                   add_fields_topic<nodmap::pitch_state_t>("PITCH_STATE"));
  subscribe<nodmap::base_sensors_t>(bus, "BASE_SENSORS",
                                    add_fields_topic<nodmap::base_sensors_t>("BASE_SENSORS"));
}

void Feed::subscribe_odometry(bus::Bus& bus) {
  const auto post_fields = add_fields_topic<nodmap::odometry_t>("ODOMETRY");
  const std::size_t frame = store_.add({"tf/base", kTransform});
  const std::size_t trail = store_.add({"trail/odometry", kPoses});
  const std::size_t robot = add_scene_topic("robot");
  subscribe<nodmap::odometry_t>(bus, "ODOMETRY", [=, this](const auto& message) {
    const auto T_odom_base = node::read_odometry(message);
    if (!T_odom_base) {
      counts_.reject("pose_not_valid");
      return;
    }
    const time::Timestamp stamp = node::stamp_of(message);
    post_fields(message);
    post(frame, stamp, [stamp, pose = *T_odom_base] {
      return frame_transform(stamp, frames::kOdom, frames::kBase, pose);
    });
    post_trail(trail, odometry_trail_, stamp, *T_odom_base);
    if (!std::exchange(body_posted_, true)) {
      post(robot, stamp, [stamp, body = params_.robot.body] { return body_scene(stamp, body); });
    }
  });
}

void Feed::subscribe_decisions(bus::Bus& bus) {
  subscribe<nodmap::drive_t>(bus, "DRIVE", add_fields_topic<nodmap::drive_t>("DRIVE"));
  const auto post_stop = add_fields_topic<nodmap::stop_t>("STOP");
  const std::size_t stop_state = store_.add({"stop_state", "nodmap.stop_state"});
  subscribe<nodmap::stop_t>(bus, "STOP", [=, this, &bus](const auto& message) {
    post_stop(message);
    stop_state_.take(message, bus.origin().arrived);
    post(stop_state, node::stamp_of(message), [state = stop_state_] { return state.to_json(); });
  });
  // The viewer's own STATUS comes once a second, whoever else has died.
  subscribe<nodmap::status_t>(bus, "STATUS", [=, this, &bus](const auto& message) {
    if (stop_state_.pass(bus.origin().arrived)) {
      post(stop_state, node::stamp_of(message), [state = stop_state_] { return state.to_json(); });
    }
  });
  subscribe<nodmap::navigation_t>(
      bus, "NAVIGATION",
      [this, post_fields = add_fields_topic<nodmap::navigation_t>("NAVIGATION"),
       corridor = add_scene_topic("corridor")](const auto& message) {
        post_fields(message);
        post(corridor, node::stamp_of(message),
             [message, body = params_.robot.body] { return corridor_scene(message, body); });
      });
  subscribe<nodmap::pitch_command_t>(
      bus, "PITCH_COMMAND",
      [this, post_fields = add_fields_topic<nodmap::pitch_command_t>("PITCH_COMMAND"),
       area = add_scene_topic("area_of_interest")](const auto& message) {
        post_fields(message);
        post(area, node::stamp_of(message),
             [message, p = p_base_mount_, body = params_.robot.body] {
               return area_of_interest_scene(message, p, body);
             });
      });
  subscribe<nodmap::goal_t>(bus, "GOAL",
                            [this, post_fields = add_fields_topic<nodmap::goal_t>("GOAL"),
                             mark = add_scene_topic("goal")](const auto& message) {
                              post_fields(message);
                              post(mark, node::stamp_of(message),
                                   [message] { return goal_scene(message); });
                            });
}

void Feed::subscribe_egomap(bus::Bus& bus, const char* channel) {
  const std::size_t topic = store_.add({channel, kPointCloud});
  subscribe<nodmap::egomap_t>(bus, channel, [this, topic](const auto& message) {
    const auto T_odom_base = node::read_pose(message.position_m, message.orientation);
    if (!T_odom_base || !have_same_lengths(message)) {
      counts_.reject("egomap_not_valid");
      return;
    }
    counts_.use();
    post(topic, node::stamp_of(message),
         [message, pose = *T_odom_base] { return egomap_cloud(message, pose); });
  });
}

void Feed::subscribe_slam_pose(bus::Bus& bus, const SlamChannel& slam) {
  const auto post_fields = add_fields_topic<nodmap::pose_t>(slam.channel);
  const std::size_t frame = store_.add({slam.frame_topic, kTransform});
  const std::size_t trail = store_.add({slam.trail_topic, kPoses});
  subscribe<nodmap::pose_t>(bus, slam.channel, [=, this](const auto& message) {
    const auto T_map_base = node::read_pose(message.position_m, message.orientation);
    const auto T_map_odom = node::read_pose(message.odom_position_m, message.odom_orientation);
    if (!T_map_base || !T_map_odom) {
      counts_.reject("pose_not_valid");
      return;
    }
    post_fields(message);
    post(frame, node::stamp_of(message),
         [make = slam.frame, stamp = node::stamp_of(message), pose = *T_map_odom] {
           return make(stamp, pose);
         });
    post_trail(trail, slam.trail, node::stamp_of(message), *T_map_base);
  });
}

void Feed::subscribe_maps(bus::Bus& bus) {
  const std::size_t map_2d = store_.add({"MAP_2D", "foxglove.Grid"});
  subscribe<nodmap::grid_chunk_t>(bus, "MAP_2D", [this, map_2d](const auto& message) {
    if (auto view = take(grid_.add(message), "map_tile_not_valid")) {
      post(map_2d, node::stamp_of(message), [view = std::move(*view)] { return grid(view); });
    }
  });
  const std::size_t local_map = store_.add({"LOCAL_MAP", "foxglove.Grid"});
  subscribe<nodmap::local_map_t>(bus, "LOCAL_MAP", [this, local_map](const auto& message) {
    if (!is_valid(message)) {
      counts_.reject("local_map_not_valid");
      return;
    }
    counts_.use();
    post(local_map, node::stamp_of(message), [message] { return local_map_grid(message); });
  });
  subscribe<nodmap::path_t>(
      bus, "PATH", [this, path = add_scene_topic("path")](const auto& message) {
        counts_.use();
        post(path, node::stamp_of(message), [message] { return path_scene(message); });
      });
  subscribe<nodmap::tracks_t>(
      bus, "TRACKS", [this, tracks = add_scene_topic("tracks")](const auto& message) {
        counts_.use();
        post(tracks, node::stamp_of(message), [message] { return tracks_scene(message); });
      });
  subscribe<nodmap::exploration_t>(
      bus, "EXPLORATION",
      [this, post_fields = add_fields_topic<nodmap::exploration_t>("EXPLORATION"),
       scene = add_scene_topic("exploration")](const auto& message) {
        post_fields(message);
        post(scene, node::stamp_of(message), [message] { return exploration_scene(message); });
      });
  subscribe<nodmap::pose_graph_t>(
      bus, "POSE_GRAPH", [this, graph = add_scene_topic("pose_graph")](const auto& message) {
        counts_.use();
        post(graph, node::stamp_of(message), [message] { return pose_graph_scene(message); });
      });
  const std::size_t octomap = store_.add({"OCTOMAP", "foxglove.VoxelGrid"});
  subscribe<nodmap::octomap_chunk_t>(bus, "OCTOMAP", [this, octomap](const auto& message) {
    if (auto view = take(octomap_.add(message), "octomap_part_not_valid")) {
      post(octomap, node::stamp_of(message),
           [view = std::move(*view)] { return voxel_grid(view.stamp, to_voxel_grid(view.space)); });
    }
  });
}

void Feed::subscribe_cloud(bus::Bus& bus) {
  const std::size_t topic =
      store_.add({"CLOUD", kPointCloud, Keep::kAll, max_cloud_points(params_)});
  const std::size_t keyframes = store_.add({"keyframes", kPoses});
  subscribe<nodmap::cloud_chunk_t>(bus, "CLOUD", [=, this, &bus](const auto& message) {
    if (!follow_cloud(topic, bus.origin().sender)) {
      return;
    }
    auto cloud = take(cloud_.add(message), "cloud_part_not_valid");
    if (!cloud) {
      return;
    }
    if (keyframe_ids_.contains(message.keyframe_id)) {
      forget_cloud(topic);  // the numbers begin again with the map, also in the same process
    }
    keyframe_ids_.insert(message.keyframe_id);
    keyframes_.set(node::stamp_of(message), cloud->T_frame_points);
    post(keyframes, node::stamp_of(message), [this] { return keyframes_.poses_in_frame(); });
    cloud_downsampler_.downsample(*cloud);
    const std::size_t points = cloud->xyz_m.size() / 3;
    if (points > 0) {
      post(
          topic, node::stamp_of(message), [view = std::move(*cloud)] { return point_cloud(view); },
          points);
    }
  });
  subscribe<nodmap::pose_graph_6d_t>(
      bus, "POSE_GRAPH_6D",
      [=, this, &bus, scene = add_scene_topic("pose_graph_6d")](const auto& message) {
        if (!follow_cloud(topic, bus.origin().sender)) {
          return;
        }
        counts_.use();
        keyframes_.move_to(keyframe_poses(message));
        post(keyframes, node::stamp_of(message), [this] { return keyframes_.poses_in_frame(); });
        post(scene, node::stamp_of(message), [message] { return pose_graph_6d_scene(message); });
      });
}

// A 6D SLAM that was started again begins another map in another frame. The former one stays
// refused: two that send at the same time would take the map from each other with each message.
bool Feed::follow_cloud(std::size_t topic, const bus::Sender& sender) {
  if (sender == former_cloud_sender_) {
    counts_.reject("former_sender_of_cloud");
    return false;
  }
  if (cloud_sender_ && *cloud_sender_ != sender) {
    former_cloud_sender_ = cloud_sender_;
    forget_cloud(topic);
  }
  cloud_sender_ = sender;
  return true;
}

void Feed::forget_cloud(std::size_t topic) {
  store_.clear(topic);
  keyframes_.clear();
  keyframe_ids_.clear();
  cloud_downsampler_.clear();
}

void Feed::subscribe_truth(bus::Bus& bus) {
  const auto post_fields = add_fields_topic<nodmap::truth_t>("TRUTH");
  const std::size_t frame = store_.add({"tf/world", kTransform});
  const std::size_t people = add_scene_topic("people");
  subscribe<nodmap::truth_t>(bus, "TRUTH", [=, this](const auto& message) {
    const auto T_world_base = node::read_pose(message.position_m, message.orientation);
    if (!T_world_base) {
      counts_.reject("pose_not_valid");
      return;
    }
    post_fields(message);
    post(frame, node::stamp_of(message),
         [stamp = node::stamp_of(message), pose = T_world_base->inverse()] {
           return frame_transform(stamp, frames::kBase, frames::kWorld, pose);
         });
    post(people, node::stamp_of(message), [message] { return people_scene(message); });
  });
}

}  // namespace nodmap::foxglove
