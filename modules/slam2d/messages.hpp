// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/time.hpp"
#include "common/node/health.hpp"
#include "modules/slam2d/back_end/back_end.hpp"
#include "modules/slam2d/grid/occupancy_grid.hpp"
#include "modules/slam2d/pose_update.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "nodmap/pose_graph_t.hpp"
#include "nodmap/pose_t.hpp"

namespace nodmap::slam2d {

/// `T_odom_published`: see LevelScanInput.
[[nodiscard]] nodmap::pose_t write_pose(const PoseUpdate& update,
                                        const geometry::SE2& T_odom_published);

/// What STATUS says of the last pose. `lacks_odometry`: the last level scan has none for that
/// reason.
[[nodiscard]] node::Health health_of(PoseState state, bool lacks_odometry);

/// Of more than 2000 loops only the newest.
[[nodiscard]] nodmap::pose_graph_t write_graph(time::Timestamp stamp, const BackEnd& back_end);

/// A tile of the map; the stamp, the revision and the number of the chunk are left to the caller.
[[nodiscard]] nodmap::grid_chunk_t write_tile(const OccupancyGrid& grid, GridTile tile);

}  // namespace nodmap::slam2d
