// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/messages.hpp"

#include <algorithm>

#include "common/node/messages.hpp"

namespace nodmap::slam6d {
namespace {

using Graph = nodmap::pose_graph_6d_t;

// 60 kB: with its header a part stays below 64 KiB.
constexpr std::size_t kPointsPerChunk = 5000;
// 48 bytes each, 1.1 km at a keyframe a metre, and 9 bytes each: 63 kB.
constexpr std::size_t kMaxKeyframes = 1100;
constexpr std::size_t kMaxLoops = 1100;

std::int8_t pose_state(const PoseUpdate& update) {
  if (!update.is_place_known) {
    return nodmap::pose_t::LOST;
  }
  if (!update.registration) {
    // The first sweep is the map. A sweep that is too thin to be registered follows odometry.
    return update.keyframe ? nodmap::pose_t::TRACKING : nodmap::pose_t::DEGRADED;
  }
  switch (update.registration->state) {
    case PoseState::kTracking:
      return nodmap::pose_t::TRACKING;
    case PoseState::kDegraded:
      return nodmap::pose_t::DEGRADED;
    case PoseState::kLost:
      return nodmap::pose_t::LOST;
  }
  return nodmap::pose_t::LOST;
}

std::int8_t loop_state(const KeyframeGraph::WeightedLoop& loop) {
  return loop.is_contradicted() ? Graph::OUTLIER : Graph::ACCEPTED;
}

std::int8_t loop_state(const RefusedLoop& loop) {
  switch (loop.reason) {
    case LoopRefusal::kLowScore:
      return Graph::LOW_SCORE;
    case LoopRefusal::kAmbiguous:
      return Graph::AMBIGUOUS;
    case LoopRefusal::kUnconfirmed:
      return Graph::UNCONFIRMED;
  }
  return Graph::LOW_SCORE;
}

// A loop between two keyframes, by their numbers.
struct GraphLoop {
  std::size_t from;
  std::size_t to;
  std::int8_t state;
};

std::vector<GraphLoop> newest_loops(const BackEnd& back_end, std::size_t first_keyframe) {
  std::vector<GraphLoop> loops;
  for (const KeyframeGraph::WeightedLoop& loop : back_end.graph().loops()) {
    loops.push_back({loop.edge.from, loop.edge.to, loop_state(loop)});
  }
  for (const RefusedLoop& loop : back_end.refused_loops()) {
    loops.push_back({loop.from, loop.to, loop_state(loop)});
  }
  std::erase_if(loops, [first_keyframe](const GraphLoop& loop) {
    return std::min(loop.from, loop.to) < first_keyframe;
  });
  std::ranges::stable_sort(loops, std::ranges::greater{}, &GraphLoop::to);
  loops.resize(std::min(loops.size(), kMaxLoops));
  return loops;
}

}  // namespace

nodmap::pose_t write_pose(const PoseUpdate& update) {
  nodmap::pose_t message =
      node::write_corrected_pose(update.stamp, update.T_map_base, update.T_map_odom);
  if (update.registration) {
    message.inlier_ratio = update.registration->inlier_ratio;
    message.inlier_rms_m = update.registration->residual_rms_m;
  }
  message.state = pose_state(update);
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      message.covariance[row][column] = update.covariance(row, column);
    }
  }
  return message;
}

std::vector<nodmap::cloud_chunk_t> write_cloud_chunks(const Keyframe& keyframe) {
  const std::vector<OrientedPoint>& points = keyframe.points;
  std::vector<nodmap::cloud_chunk_t> chunks;
  nodmap::cloud_chunk_t message{};
  message.utime = time::to_utime(keyframe.cloud->stamp);
  message.keyframe_id = static_cast<std::int64_t>(keyframe.id);
  message.num_chunks =
      static_cast<std::int32_t>((points.size() + kPointsPerChunk - 1) / kPointsPerChunk);
  node::write_pose(keyframe.T_map_base, message.position_m, message.orientation);
  for (; message.chunk_index < message.num_chunks; ++message.chunk_index) {
    const std::size_t first = static_cast<std::size_t>(message.chunk_index) * kPointsPerChunk;
    const std::size_t end = std::min(first + kPointsPerChunk, points.size());
    message.num_points = static_cast<std::int32_t>(end - first);
    message.points_m.clear();
    for (std::size_t i = first; i < end; ++i) {
      const Eigen::Vector3f& p = points[i].p;
      message.points_m.push_back({p.x(), p.y(), p.z()});
    }
    chunks.push_back(message);
  }
  return chunks;
}

nodmap::pose_graph_6d_t write_graph(time::Timestamp stamp, std::span<const Keyframe> keyframes,
                                    const BackEnd& back_end) {
  const std::size_t first = keyframes.size() - std::min(keyframes.size(), kMaxKeyframes);
  Graph message{};
  message.utime = time::to_utime(stamp);
  message.first_keyframe_id = static_cast<std::int64_t>(keyframes[first].id);
  for (const Keyframe& keyframe : keyframes.subspan(first)) {
    const Eigen::Vector3d& p = keyframe.T_map_base.translation();
    const Eigen::Quaternionf q(keyframe.T_map_base.linear().cast<float>());
    message.keyframe_utime.push_back(time::to_utime(keyframe.cloud->stamp));
    message.position_m.push_back({p.x(), p.y(), p.z()});
    message.orientation.push_back({q.w(), q.x(), q.y(), q.z()});
  }
  message.num_keyframes = static_cast<std::int32_t>(message.keyframe_utime.size());
  for (const GraphLoop& loop : newest_loops(back_end, first)) {
    message.from_keyframe.push_back(static_cast<std::int32_t>(loop.from - first));
    message.to_keyframe.push_back(static_cast<std::int32_t>(loop.to - first));
    message.loop_state.push_back(loop.state);
  }
  message.num_loops = static_cast<std::int32_t>(message.loop_state.size());
  return message;
}

}  // namespace nodmap::slam6d
