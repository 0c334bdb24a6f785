// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/node.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "common/node/messages.hpp"
#include "modules/map_server/results.hpp"

namespace nodmap::map_server {
namespace {

nlohmann::json metrics_of(const EgoMap& map) {
  std::size_t points = 0;
  double nearest_m = std::numeric_limits<double>::infinity();
  double farthest_m = 0.0;
  for (const EgoPoint& point : map.scan().points()) {
    if (point.valid) {
      ++points;
      nearest_m = std::min(nearest_m, point.distance_m);
      farthest_m = std::max(farthest_m, point.distance_m);
    }
  }
  nlohmann::json metrics{
      {"bins", map.scan().size()}, {"points", points}, {"points_removed", map.removed()}};
  if (points > 0) {
    metrics["nearest_m"] = nearest_m;
    metrics["farthest_m"] = farthest_m;
  }
  return metrics;
}

}  // namespace

MapServerNode::MapServerNode(node::Context& context, const Params& params)
    : context_(context), params_(params), input_(context.counts, &context.bus), server_(params) {
  context.bus.subscribe<nodmap::scan_t>(
      "SCAN", [this](const nodmap::scan_t& message) { on_scan(message); });
  context.bus.subscribe<nodmap::odometry_t>(
      "ODOMETRY", [this](const nodmap::odometry_t& message) { on_odometry(message); });
}

void MapServerNode::on_odometry(const nodmap::odometry_t& message) {
  const auto T_odom_base = input_.read(message);
  if (!T_odom_base) {
    return;
  }
  // The motion between the old odom frame and the new one is unknown.
  if (input_.odometry_restarted()) {
    server_.reset();
    odometry_.clear();
  }
  odometry_.add(node::stamp_of(message), *T_odom_base);
  context_.counts.use();
}

void MapServerNode::on_scan(const nodmap::scan_t& message) {
  if (!input_.read(message, scan_)) {
    return;
  }
  const auto T_odom_base = pose_at(scan_.mid_stamp());
  last_scan_had_odometry_ = T_odom_base.has_value();
  if (!T_odom_base) {
    context_.counts.reject("scan_without_odometry");
    return;
  }
  // From here on, heights in base are heights above the ground.
  scan_.T_base_mount.translation().z() += params_.base_height_m;
  switch (server_.add_scan(scan_, *T_odom_base)) {
    case ScanStatus::kImplausibleScan:
      context_.counts.reject("implausible_scan");
      return;
    case ScanStatus::kImplausiblePose:
      context_.counts.reject("implausible_pose");
      return;
    case ScanStatus::kUsed:
      break;
  }
  context_.counts.use();
  ++scans_used_;
  publish_maps(*T_odom_base);
}

std::optional<geometry::SE3> MapServerNode::pose_at(time::Timestamp stamp) const {
  if (params_.assume_stationary) {
    return geometry::SE3::Identity();
  }
  return odometry_.at(stamp);
}

void MapServerNode::publish_maps(const geometry::SE3& T_odom_base) {
  fill_message(server_.obstacle_map(), T_odom_base);
  context_.bus.publish("OBSTACLE_MAP", message_);
  fill_message(server_.structure_map(), T_odom_base);
  context_.bus.publish("STRUCTURE_MAP", message_);
}

void MapServerNode::fill_message(const EgoMap& map, const geometry::SE3& T_odom_base) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const ExtendedScan& scan = map.scan();
  const std::size_t n = scan.size();
  message_.utime = time::to_utime(scan_.mid_stamp());
  message_.scan_seq = scan_.seq;
  message_.bin_first_rad = scan.bins().first_rad();
  message_.bin_step_rad = scan.bins().step_rad();
  node::write_pose(T_odom_base, message_.position_m, message_.orientation);
  message_.num_bins = static_cast<std::int32_t>(n);
  message_.distance_m.assign(n, std::numeric_limits<float>::infinity());
  for (auto* field :
       {&message_.point_x_m, &message_.point_y_m, &message_.point_z_m, &message_.age_s}) {
    field->assign(n, kNone);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const EgoPoint& point = scan[i];
    if (point.valid) {
      message_.distance_m[i] = static_cast<float>(point.distance_m);
      message_.point_x_m[i] = static_cast<float>(point.p_base.x());
      message_.point_y_m[i] = static_cast<float>(point.p_base.y());
      message_.point_z_m[i] = static_cast<float>(point.height_m);
      message_.age_s[i] = static_cast<float>(server_.age_s(point));
    }
  }
}

void MapServerNode::write_results(const std::filesystem::path& dir) {
  draw_maps(server_.obstacle_map().scan(), server_.structure_map().scan(),
            params_.robot.body.footprint())
      .write_png(dir / "map.png");
}

nlohmann::json MapServerNode::metrics() const {
  return {{"scans_used", scans_used_},
          {"obstacle_map", metrics_of(server_.obstacle_map())},
          {"structure_map", metrics_of(server_.structure_map())}};
}

node::Health MapServerNode::health() const {
  if (!last_scan_had_odometry_) {
    return {node::HealthState::kDegraded, "No odometry for the scans: the maps are not updated."};
  }
  return {};
}

}  // namespace nodmap::map_server
