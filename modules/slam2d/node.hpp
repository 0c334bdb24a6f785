// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "common/geometry/pose_history.hpp"
#include "common/input/sensor_input.hpp"
#include "common/node/node.hpp"
#include "modules/slam2d/level_scan_selector.hpp"
#include "modules/slam2d/occupancy_grid.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/slam2d.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::slam2d {

/// The shell of 3DOF SLAM: SCAN and ODOMETRY in, POSE_2D and MAP_2D out; at SAVE_REQUEST the map is
/// written.
class Slam2dNode : public node::Node {
 public:
  using Params = Slam2dParams;

  Slam2dNode(node::Context& context, const Params& params);

  void finish() override;
  void write_results(const std::filesystem::path& dir) override;
  [[nodiscard]] nlohmann::json figures() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  void on_odometry(const nodmap::odometry_t& message);
  void on_scan(const nodmap::scan_t& message);
  void on_save_request(const nodmap::save_request_t& message);
  void begin_odometry_frame(const geometry::SE3& T_odom_base);
  void track(const scan::Scan& scan);
  void publish_pose(const Slam2dResult& result);
  void draw_new_keyframes();
  void redraw_moved_keyframes(std::size_t looked_at, std::size_t redrawn);
  void publish_map(std::int64_t utime_us);

  node::Context& context_;
  Params params_;
  input::SensorInput input_;
  geometry::PoseHistory odometry_;
  LevelScanSelector selector_;
  Slam2d slam_;
  OccupancyGrid grid_;
  scan::Scan scan_;                      // kept for its memory
  std::vector<geometry::SE2> drawn_at_;  // T_map_base of each keyframe in the grid
  std::size_t next_redrawn_ = 0;
  bool grid_changed_ = false;
  std::int64_t maps_published_ = 0;
  std::int64_t not_level_ = 0;
  std::optional<std::int64_t> last_map_utime_us_;
  std::int64_t last_utime_us_ = 0;
  PoseQuality last_quality_ = PoseQuality::kTracked;
  std::string save_error_;  // of the last try; empty when it went well
};

}  // namespace nodmap::slam2d
