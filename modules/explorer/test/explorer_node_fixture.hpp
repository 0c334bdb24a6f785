// SPDX-License-Identifier: BSD-3-Clause
// For tests: the explorer's process in a corridor, on a bus in memory.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "common/node/messages.hpp"
#include "modules/explorer/node.hpp"
#include "modules/explorer/test/grid_world.hpp"
#include "tests/support/memory_bus.hpp"

namespace nodmap::explorer::test {

class ExplorerNodeTest : public ::testing::Test {
 protected:
  ExplorerNodeTest() : world_({-4.0, -4.0}, {8.0, 4.0}), node_(context_, {}) {
    world_.add_wall({-0.5, -1.0}, {5.0, -1.0});
    world_.add_wall({-0.5, 1.0}, {5.0, 1.0});
    world_.scan({0.0, 0.0, 0.0});
    bus_.deliver("POSE_2D", pose_message());  // the map is in the frame of the poses
  }

  /// Closes the corridor; the map shows all of it.
  void see_everything() {
    world_.add_wall({-0.5, -1.0}, {-0.5, 1.0});
    world_.add_wall({5.0, -1.0}, {5.0, 1.0});
    for (const double x : {0.0, 4.0}) {
      for (int i = 0; i < 4; ++i) {
        world_.scan({x, 0.0, 0.5 * geometry::kPi * i});
      }
    }
  }
  void give_map(std::int64_t revision = 0) { bus_.deliver("MAP_2D", map_message(revision)); }
  [[nodiscard]] nodmap::grid_chunk_t map_message(std::int64_t revision) const {
    const MapTile tile = world_.map();
    nodmap::grid_chunk_t message{};
    message.map_revision = revision;
    message.num_chunks = 1;
    message.cell_size_m = tile.cell_size_m;
    message.origin_x_m = tile.cell_size_m * tile.first.x();
    message.origin_y_m = tile.cell_size_m * tile.first.y();
    message.grid_width = message.tile_width = tile.width;
    message.grid_height = message.tile_height = tile.height;
    message.num_cells = static_cast<std::int32_t>(tile.cells.size());
    message.cells.assign(tile.cells.begin(), tile.cells.end());
    return message;
  }
  // Lets half a second pass and delivers a pose.
  nodmap::exploration_t give_pose(std::int8_t state = nodmap::pose_t::TRACKING) {
    utime_us_ += 500'000;
    bus_.deliver("POSE_2D", pose_message(state));
    give_odometry(0.0);
    return bus_.last<nodmap::exploration_t>("EXPLORATION");
  }
  [[nodiscard]] nodmap::pose_t pose_message(std::int8_t state = nodmap::pose_t::TRACKING) const {
    nodmap::pose_t pose = node::write_corrected_pose(
        time::from_utime(utime_us_), geometry::SE3::Identity(), geometry::SE3::Identity());
    pose.state = state;
    return pose;
  }
  void give_odometry(double x_m) {
    nodmap::odometry_t message = node::write_odometry(
        time::from_utime(utime_us_), geometry::SE3(Eigen::Translation3d(x_m, 0.0, 0.0)));
    message.odometry_seq = odometry_seq_++;
    bus_.deliver("ODOMETRY", message);
  }
  void ask(bool is_active) {
    nodmap::explore_t message{};
    message.is_active = static_cast<std::int8_t>(is_active);
    message.requested_by = "somebody";
    bus_.deliver("EXPLORE", message);
  }
  void stop(bool is_stopped) {
    nodmap::stop_t message{};
    message.utime = ++num_stops_;
    message.is_stopped = static_cast<std::int8_t>(is_stopped);
    bus_.deliver("STOP", message);
  }

  void give_navigation(std::int8_t behaviour, const std::string& reason = "") {
    nodmap::navigation_t navigation{};
    navigation.utime = utime_us_;
    navigation.behaviour = behaviour;
    navigation.reason = reason;
    bus_.deliver("NAVIGATION", navigation);
  }

  /// The navigator says that there is no path to a goal.
  void give_no_path(std::int64_t goal_utime) {
    nodmap::path_t path{};
    path.utime = utime_us_;
    path.state = nodmap::path_t::NO_PATH;
    path.goal_utime = goal_utime;
    bus_.deliver("PATH", path);
  }

  [[nodiscard]] std::int64_t num_decisions() const { return node_.metrics().at("decisions"); }

  GridWorld world_;
  ::nodmap::test::MemoryBus bus_;
  node::MessageCounts counts_;
  node::Context context_{bus_, counts_, {}};
  ExplorerNode node_;
  std::int64_t utime_us_ = 0;
  std::int64_t num_stops_ = 0;
  std::int64_t odometry_seq_ = 0;
};

}  // namespace nodmap::explorer::test
