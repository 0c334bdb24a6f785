// SPDX-License-Identifier: BSD-3-Clause
// What 6D SLAM publishes, as messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/time.hpp"
#include "modules/slam6d/slam6d.hpp"
#include "nodmap/cloud_chunk_t.hpp"
#include "nodmap/pose_graph_6d_t.hpp"
#include "nodmap/pose_t.hpp"

namespace nodmap::slam6d {

[[nodiscard]] nodmap::pose_t write_pose(const PoseUpdate& update);

/// The voxel means of a keyframe, in parts of less than 64 KiB.
[[nodiscard]] std::vector<nodmap::cloud_chunk_t> write_cloud_chunks(const Keyframe& keyframe);

/// All keyframes and loops, or the newest that fit into one message.
[[nodiscard]] nodmap::pose_graph_6d_t write_graph(time::Timestamp stamp,
                                                  std::span<const Keyframe> keyframes,
                                                  const BackEnd& back_end);

}  // namespace nodmap::slam6d
