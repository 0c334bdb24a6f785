// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <vector>

#include "common/node/message_input.hpp"
#include "common/node/node.hpp"
#include "modules/slam2d/occupancy_grid.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/slam2d.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::slam2d {

[[nodiscard]] nodmap::pose_t write_pose(const PoseUpdate& update);

/// The shell of Slam2d: subscribes SCAN and ODOMETRY, publishes POSE_2D and MAP_2D, and saves the
/// map at SAVE_REQUEST.
class Slam2dNode : public node::Node {
 public:
  using Params = Slam2dParams;

  Slam2dNode(node::Context& context, const Params& params);

  void finish() override;
  void write_results(const std::filesystem::path& dir) override;
  [[nodiscard]] nlohmann::json metrics() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  void on_odometry(const nodmap::odometry_t& message);
  void on_scan(const nodmap::scan_t& message);
  void on_save_request(const nodmap::save_request_t& message);
  void count_rejected(const ScanCounts& before, std::int64_t without_points_before);
  void draw_new_keyframes();
  /// Draws keyframes again that the back end has moved: looks at `max_checked` of them, and draws
  /// `max_drawn` at most.
  void redraw_moved_keyframes(std::size_t max_checked, std::size_t max_drawn);
  /// `utime_us`: of the newest measurement in the map.
  void publish_map(std::int64_t utime_us, std::vector<GridTile> tiles);

  node::Context& context_;
  Params params_;
  node::SensorInput input_;
  Slam2d slam_;
  OccupancyGrid grid_;
  TileSelector tile_selector_;
  scan::Scan scan_;                      // the last one; a member to reuse its memory
  std::vector<geometry::SE2> drawn_at_;  // T_map_base of each keyframe in the grid
  std::size_t next_redrawn_ = 0;
  std::int64_t maps_published_ = 0;
  std::optional<std::int64_t> last_map_utime_us_;
  std::int64_t last_utime_us_ = 0;
  PoseQuality last_quality_ = PoseQuality::kTracked;
  std::string save_error_;  // of the last attempt; empty when it succeeded
};

}  // namespace nodmap::slam2d
