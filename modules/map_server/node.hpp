// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "common/geometry/pose_history.hpp"
#include "common/geometry/time.hpp"
#include "common/node/node.hpp"
#include "common/node/sensor_input.hpp"
#include "common/scan/scan.hpp"
#include "modules/map_server/map_server.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::map_server {

/// Subscribes to SCAN and ODOMETRY, and publishes OBSTACLE_MAP and STRUCTURE_MAP after every scan
/// that was used. For a scan that cannot be used it publishes nothing, so a map never has a newer
/// stamp than its points.
class MapServerNode final : public node::Node {
 public:
  using Params = MapServerParams;

  MapServerNode(node::Context& context, const Params& params);

  void write_results(const std::filesystem::path& dir) override;
  [[nodiscard]] nlohmann::json metrics() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  void on_scan(const nodmap::scan_t& message);
  void on_odometry(const nodmap::odometry_t& message);
  [[nodiscard]] std::optional<geometry::SE3> pose_at(time::Timestamp stamp) const;
  void publish_maps(const geometry::SE3& T_odom_base);
  void fill_message(const EgoMap& map, const geometry::SE3& T_odom_base);

  node::Context& context_;
  Params params_;
  node::SensorInput input_;
  MapServer server_;
  geometry::PoseHistory odometry_;
  scan::Scan scan_;             // reused for every message, to avoid allocations
  nodmap::egomap_t message_{};  // reused likewise
  std::int64_t scans_used_ = 0;
  bool last_scan_had_odometry_ = true;
};

}  // namespace nodmap::map_server
