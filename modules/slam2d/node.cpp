// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/node.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/formats/tum.hpp"
#include "common/input/save_request.hpp"
#include "common/log/log.hpp"
#include "common/msg/messages.hpp"
#include "modules/slam2d/grid_tiles.hpp"
#include "modules/slam2d/map_file.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "nodmap/pose_t.hpp"

namespace nodmap::slam2d {

static_assert(static_cast<int>(PoseQuality::kTracked) == nodmap::pose_t::TRACKED);
static_assert(static_cast<int>(PoseQuality::kPartly) == nodmap::pose_t::PARTLY);
static_assert(static_cast<int>(PoseQuality::kOdometry) == nodmap::pose_t::ODOMETRY);
static_assert(static_cast<int>(PoseQuality::kLost) == nodmap::pose_t::LOST);

namespace {

constexpr std::size_t kLookedAtPerScan = 100;
constexpr std::size_t kRedrawnPerScan = 2;

/// Whether what is seen from there lands in other cells of the grid.
bool has_moved(const geometry::SE2& from, const geometry::SE2& to, double cell_size_m) {
  constexpr double kTypicalRangeM = 5.0;
  return std::hypot(to.x - from.x, to.y - from.y) +
             kTypicalRangeM * std::abs(geometry::angle_difference(to.yaw, from.yaw)) >
         0.5 * cell_size_m;
}

void write_tile(const OccupancyGrid& grid, const GridTile& tile, nodmap::grid_chunk_t& message) {
  message.cell_size_m = grid.cell_size_m();
  message.origin_x_m = grid.origin().x();
  message.origin_y_m = grid.origin().y();
  message.grid_width = grid.width();
  message.grid_height = grid.height();
  message.tile_x = tile.x;
  message.tile_y = tile.y;
  message.tile_width = tile.width;
  message.tile_height = tile.height;
  message.num_cells = static_cast<std::int32_t>(tile.cells.size());
  message.cells = tile.cells;
}

}  // namespace

Slam2dNode::Slam2dNode(node::Context& context, const Params& params)
    : context_(context),
      params_(params),
      input_(context.tally),
      selector_(params.max_level_pitch_rad),
      slam_(params),
      grid_(params.cell_size_m) {
  context_.bus.subscribe<nodmap::odometry_t>(
      "ODOMETRY", [this](const nodmap::odometry_t& message) { on_odometry(message); });
  context_.bus.subscribe<nodmap::scan_t>(
      "SCAN", [this](const nodmap::scan_t& message) { on_scan(message); });
  context_.bus.subscribe<nodmap::save_request_t>(
      "SAVE_REQUEST", [this](const nodmap::save_request_t& message) { on_save_request(message); });
}

void Slam2dNode::on_odometry(const nodmap::odometry_t& message) {
  const auto T_odom_base = input_.read(message);
  if (!T_odom_base) {
    return;
  }
  if (input_.odometry_began_anew()) {
    begin_odometry_frame(*T_odom_base);
  }
  odometry_.add(message.utime, *T_odom_base);
  context_.tally.use();
}

void Slam2dNode::begin_odometry_frame(const geometry::SE3& T_odom_base) {
  if (const auto T_old_odom_base = odometry_.newest()) {
    slam_.change_odometry_frame(geometry::to_se2(*T_old_odom_base), geometry::to_se2(T_odom_base));
  }
  odometry_.clear();
}

void Slam2dNode::on_scan(const nodmap::scan_t& message) {
  if (!input_.read(message, scan_)) {
    return;
  }
  if (const scan::Scan* level = selector_.add(scan_)) {
    track(*level);
  } else {
    ++not_level_;
  }
}

// A full disk does not end the mapping: the last map that was whole stays, and STATUS says so.
void Slam2dNode::on_save_request(const nodmap::save_request_t& message) {
  if (!input::accept(message, context_)) {
    return;
  }
  try {
    write_ros_map(context_.out_dir, grid_);
    save_error_.clear();
  } catch (const std::runtime_error& error) {
    save_error_ = error.what();
    log::get().warn("map not saved: {}", save_error_);
  }
}

void Slam2dNode::track(const scan::Scan& scan) {
  const auto T_odom_first = odometry_.at(scan.utime_us);
  if (!T_odom_first) {
    context_.tally.reject("no_odometry");
    return;
  }
  const auto T_odom_last = odometry_.at(scan.utime_last_us()).value_or(*T_odom_first);
  const geometry::SE2 T_odom_base = geometry::to_se2(*T_odom_first);
  const auto result =
      slam_.add_scan(scan, T_odom_base, T_odom_base.inverse() * geometry::to_se2(T_odom_last));
  if (!result) {
    context_.tally.reject("nothing_seen");
    return;
  }
  context_.tally.use();
  last_quality_ = result->quality;
  last_utime_us_ = result->utime_us;
  publish_pose(*result);
  draw_new_keyframes();
  redraw_moved_keyframes(kLookedAtPerScan, kRedrawnPerScan);
  // Distance, not difference: a stamp that steps far back must not silence the map.
  if (!last_map_utime_us_ || std::abs(static_cast<double>(scan.utime_us - *last_map_utime_us_)) >=
                                 1e6 * params_.map_period_s) {
    publish_map(scan.utime_us);
  }
}

void Slam2dNode::finish() {
  slam_.polish();
  redraw_moved_keyframes(drawn_at_.size(), drawn_at_.size());
  publish_map(last_utime_us_);
}

void Slam2dNode::publish_pose(const Slam2dResult& result) {
  nodmap::pose_t message = msg::write_corrected_pose(
      result.utime_us, geometry::to_se3(result.T_map_base), geometry::to_se3(result.T_map_odom));
  message.match_share = result.match_share;
  message.match_rms_m = result.match_rms_m;
  message.pose_quality = static_cast<std::int8_t>(result.quality);
  context_.bus.publish("POSE_2D", message);
}

void Slam2dNode::draw_new_keyframes() {
  while (drawn_at_.size() < slam_.keyframes().size()) {
    const Keyframe& keyframe = slam_.keyframes()[drawn_at_.size()];
    draw(keyframe, keyframe.T_map_base, grid_);
    drawn_at_.push_back(keyframe.T_map_base);
    grid_changed_ = true;
  }
}

// The grid follows the corrected poses, a few keyframes with each scan.
void Slam2dNode::redraw_moved_keyframes(std::size_t looked_at, std::size_t redrawn) {
  for (looked_at = std::min(looked_at, drawn_at_.size()); looked_at > 0 && redrawn > 0;
       --looked_at) {
    next_redrawn_ = (next_redrawn_ + 1) % drawn_at_.size();
    const Keyframe& keyframe = slam_.keyframes()[next_redrawn_];
    geometry::SE2& drawn_at = drawn_at_[next_redrawn_];
    if (!has_moved(drawn_at, keyframe.T_map_base, params_.cell_size_m)) {
      continue;
    }
    erase(keyframe, drawn_at, grid_);
    draw(keyframe, keyframe.T_map_base, grid_);
    drawn_at = keyframe.T_map_base;
    grid_changed_ = true;
    --redrawn;
  }
}

void Slam2dNode::publish_map(std::int64_t utime_us) {
  if (!grid_changed_) {
    return;
  }
  const std::vector<GridTile> tiles = cut_into_tiles(grid_);
  nodmap::grid_chunk_t message{};
  message.utime = utime_us;
  message.map_revision = maps_published_;
  message.num_chunks = static_cast<std::int32_t>(tiles.size());
  for (const GridTile& tile : tiles) {
    write_tile(grid_, tile, message);
    context_.bus.publish("MAP_2D", message);
    ++message.chunk_index;
  }
  ++maps_published_;
  grid_changed_ = false;
  last_map_utime_us_ = utime_us;
}

void Slam2dNode::write_results(const std::filesystem::path& dir) {
  formats::Trajectory corrected;
  formats::Trajectory online;
  std::vector<geometry::SE2> path;
  for (const TrackedScan& scan : slam_.tracked_scans()) {
    path.push_back(slam_.corrected_pose(scan));
    corrected.push_back({scan.utime_us, geometry::to_se3(path.back())});
    online.push_back({scan.utime_us, geometry::to_se3(scan.T_map_base_online)});
  }
  std::vector<geometry::SE2> odometry;
  for (const Keyframe& keyframe : slam_.keyframes()) {
    odometry.push_back(keyframe.T_odom_base);
  }
  formats::write_tum(dir / "trajectory.tum", corrected);
  formats::write_tum(dir / "online.tum", online);
  write_ros_map(dir, grid_);
  draw_map(grid_, path).write_png(dir / "map.png");
  draw_paths(path, odometry).write_png(dir / "path.png");
}

nlohmann::json Slam2dNode::figures() const {
  const Slam2dFigures& figures = slam_.figures();
  const double scans = static_cast<double>(std::max<std::int64_t>(1, figures.scans));
  return {{"scans_used", figures.scans},
          {"scans_not_level", not_level_},
          {"map_points", slam_.back_end().num_points()},
          {"keyframes", slam_.keyframes().size()},
          {"tracked", figures.tracked},
          {"partly", figures.partly},
          {"odometry_only", figures.odometry_only},
          {"lost", figures.lost},
          {"searches", figures.searches},
          {"searches_helped", figures.searches_helped},
          {"mean_match_share", figures.share_sum / scans},
          {"mean_match_agreement", figures.agreement_sum / scans},
          {"submaps", slam_.back_end().submaps().size()},
          {"loops_tracked", slam_.back_end().metrics().loops_tracked},
          {"loops_searched", slam_.back_end().metrics().loops_searched},
          {"loop_searches", slam_.back_end().metrics().searches},
          {"loops_refused_ambiguous", slam_.back_end().metrics().refused_ambiguous},
          {"loops_refused_match", slam_.back_end().metrics().refused_match},
          {"loops_refused_by_graph", slam_.back_end().metrics().refused_by_graph},
          {"optimisations", slam_.back_end().metrics().optimisations},
          {"maps_published", maps_published_}};
}

node::Health Slam2dNode::health() const {
  if (!save_error_.empty()) {
    return {node::HealthState::kDegraded, "The map cannot be saved: " + save_error_ + "."};
  }
  if (last_quality_ == PoseQuality::kLost) {
    return {node::HealthState::kDegraded, "lost: the scan does not fit the map"};
  }
  if (last_quality_ == PoseQuality::kOdometry) {
    return {node::HealthState::kDegraded, "odometry only: the scanner sees too little"};
  }
  return {};
}

}  // namespace nodmap::slam2d
