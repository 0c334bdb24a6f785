// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/messages.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "common/node/messages.hpp"

namespace nodmap::slam2d {
namespace {

constexpr std::size_t kMaxGraphLoops = 2000;  // 26 kB

static_assert(static_cast<int>(LoopState::kAccepted) == nodmap::pose_graph_t::ACCEPTED);
static_assert(static_cast<int>(LoopState::kAmbiguous) == nodmap::pose_graph_t::AMBIGUOUS);
static_assert(static_cast<int>(LoopState::kLowScore) == nodmap::pose_graph_t::LOW_SCORE);
static_assert(static_cast<int>(LoopState::kInconsistent) == nodmap::pose_graph_t::INCONSISTENT);
static_assert(static_cast<int>(LoopState::kOutlier) == nodmap::pose_graph_t::OUTLIER);

std::int8_t pose_state(PoseState state) {
  switch (state) {
    case PoseState::kTracking:
      return nodmap::pose_t::TRACKING;
    case PoseState::kDegraded:
    case PoseState::kOdometry:
      return nodmap::pose_t::DEGRADED;
    case PoseState::kLost:
      return nodmap::pose_t::LOST;
  }
  return nodmap::pose_t::LOST;
}

}  // namespace

nodmap::grid_chunk_t write_tile(const OccupancyGrid& grid, GridTile tile) {
  nodmap::grid_chunk_t message{};
  message.cell_size_m = grid.cell_size_m();
  message.origin_x_m = grid.origin().x();
  message.origin_y_m = grid.origin().y();
  message.grid_width = grid.width();
  message.grid_height = grid.height();
  message.tile_x = tile.x;
  message.tile_y = tile.y;
  message.tile_width = OccupancyGrid::kTileCells;
  message.tile_height = OccupancyGrid::kTileCells;
  message.num_cells = static_cast<std::int32_t>(tile.cells.size());
  message.cells = std::move(tile.cells);
  return message;
}

nodmap::pose_t write_pose(const PoseUpdate& update, const geometry::SE2& T_odom_published) {
  nodmap::pose_t message =
      node::write_corrected_pose(update.stamp, geometry::to_se3(update.T_map_base),
                                 geometry::to_se3(update.T_map_odom * T_odom_published));
  message.inlier_ratio = update.inlier_ratio;
  message.inlier_rms_m = update.rms_m;
  message.state = pose_state(update.state);
  constexpr std::array<std::size_t, 3> kAxes{0, 1, 5};  // x, y, yaw
  for (std::size_t row = 0; row < kAxes.size(); ++row) {
    for (std::size_t column = 0; column < kAxes.size(); ++column) {
      message.covariance[kAxes[row]][kAxes[column]] =
          update.covariance(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
    }
  }
  return message;
}

node::Health health_of(PoseState state, bool lacks_odometry) {
  if (lacks_odometry) {
    return {node::HealthState::kDegraded, "There was no odometry for the last level scan."};
  }
  switch (state) {
    case PoseState::kLost:
      return {node::HealthState::kDegraded, "Lost: the place in the map is not known."};
    case PoseState::kOdometry:
      return {node::HealthState::kDegraded,
              "Odometry only: the scan has too few points or does not fit the map."};
    case PoseState::kTracking:
    case PoseState::kDegraded:
      break;
  }
  return {};
}

nodmap::pose_graph_t write_graph(time::Timestamp stamp, const BackEnd& back_end) {
  nodmap::pose_graph_t message{};
  message.utime = time::to_utime(stamp);
  for (const Submap& submap : back_end.submaps()) {
    message.x_m.push_back(submap.T_map_submap.x);
    message.y_m.push_back(submap.T_map_submap.y);
    message.yaw_rad.push_back(submap.T_map_submap.yaw);
  }
  message.num_submaps = static_cast<std::int32_t>(message.x_m.size());
  std::vector<SubmapLoop> loops = back_end.loops();
  if (loops.size() > kMaxGraphLoops) {
    std::stable_sort(loops.begin(), loops.end(), [](const SubmapLoop& a, const SubmapLoop& b) {
      return a.to > b.to;  // the newest first
    });
    loops.resize(kMaxGraphLoops);
  }
  for (const SubmapLoop& loop : loops) {
    message.from_submap.push_back(static_cast<std::int32_t>(loop.from));
    message.to_submap.push_back(static_cast<std::int32_t>(loop.to));
    message.loop_state.push_back(static_cast<std::int8_t>(loop.state));
    message.loop_score.push_back(static_cast<float>(loop.score));
  }
  message.num_loops = static_cast<std::int32_t>(message.from_submap.size());
  return message;
}

}  // namespace nodmap::slam2d
