// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/localiser_node.hpp"

#include <nlohmann/json.hpp>

#include "common/formats/input_file.hpp"
#include "common/node/log.hpp"
#include "modules/slam2d/grid/map_file.hpp"
#include "modules/slam2d/messages.hpp"
#include "modules/slam2d/results.hpp"

namespace nodmap::slam2d {
LocaliserNode::LocaliserNode(node::Context& context, const Slam2dParams& params,
                             const node::MapOptions& options)
    : context_(context),
      input_(params.level_scans, context.counts, &context.bus),
      map_(read_ros_map(options.localise_in), params.map),
      grid_(to_occupancy_grid(map_.grid())),
      map_publisher_(context.bus, time::from_seconds(params.grid.publish_period_s)),
      localiser_(params, map_, options.T_map_start),
      path_(params.path) {
  if (map_.points().points().empty()) {
    throw formats::InputFileError(options.localise_in.string() +
                                  ": a map without any wall beside free space");
  }
  context_.bus.subscribe<nodmap::odometry_t>(
      "ODOMETRY", [this](const nodmap::odometry_t& message) { input_.read(message); });
  context_.bus.subscribe<nodmap::scan_t>(
      "SCAN", [this](const nodmap::scan_t& message) { on_scan(message); });
  if (params.level_scans.from_structure_map) {
    context_.bus.subscribe<nodmap::egomap_t>(
        "STRUCTURE_MAP", [this](const nodmap::egomap_t& message) { on_structure_map(message); });
  }
}

void LocaliserNode::on_scan(const nodmap::scan_t& message) {
  input_.read(message);
  add_level_scans();
}

void LocaliserNode::add_level_scans() {
  while (const std::optional<LevelScan> scan = input_.next()) {
    add_scan(*scan);
  }
}

void LocaliserNode::on_structure_map(const nodmap::egomap_t& message) {
  if (const std::optional<LevelScan> scan = input_.read(message)) {
    add_scan(*scan);
  }
}

void LocaliserNode::add_scan(const LevelScan& scan) {
  const PoseUpdate update = localiser_.add_scan(scan);
  context_.counts.use();
  context_.bus.publish("POSE_2D", write_pose(update, input_.input().T_odom_published()));
  map_publisher_.publish_if_due(grid_, update.stamp);
  last_stamp_ = update.stamp;
  last_state_ = update.state;
  if (update.state != PoseState::kLost) {
    path_.add(update, {&map_frame_, 1});
  }
}

void LocaliserNode::finish() {
  input_.end_scans();
  add_level_scans();
  input_.finish();
  map_publisher_.publish_rest(grid_, last_stamp_);
  log_scans(localiser_.metrics().scans);
}

void LocaliserNode::write_results(const std::filesystem::path& dir) {
  if (path_.scans().empty()) {
    log::get().warn("the robot was not found in the saved map");
  }
  write_trajectories(dir, path_.scans(), path_.poses({&map_frame_, 1}));
}

nlohmann::json LocaliserNode::metrics() const {
  const LocaliserMetrics& metrics = localiser_.metrics();
  nlohmann::json result = scan_metrics(metrics.scans, input_.input().counts());
  result["maps_published"] = map_publisher_.num_published();
  result["map_points"] = map_.points().points().size();
  result["localisation"] = {{"searches", metrics.searches.made},
                            {"searches_found", metrics.searches.found},
                            {"times_lost", metrics.times_lost}};
  return result;
}

}  // namespace nodmap::slam2d
