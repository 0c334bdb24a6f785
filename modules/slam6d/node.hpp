// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <system_error>

#include "common/node/message_counts.hpp"
#include "common/node/message_input.hpp"
#include "common/node/node.hpp"
#include "modules/slam6d/occupancy_map.hpp"
#include "modules/slam6d/octomap_parts.hpp"
#include "modules/slam6d/params.hpp"
#include "modules/slam6d/slam6d.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::slam6d {

/// SCAN and ODOMETRY in, POSE_6D for each sweep, CLOUD for each keyframe and OCTOMAP now and then
/// out; SAVE_REQUEST writes the map.
class Slam6dNode : public node::Node {
 public:
  using Params = Slam6dParams;

  Slam6dNode(node::Context& context, const Params& params);

  void finish() override;
  void write_results(const std::filesystem::path& dir) override;
  [[nodiscard]] nlohmann::json metrics() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  void on_odometry(const nodmap::odometry_t& message);
  void on_scan(const nodmap::scan_t& message);
  void on_save_request(const nodmap::save_request_t& message);

  void answer(const std::optional<PoseUpdate>& update);
  void publish(const PoseUpdate& update);
  void answer_keyframe(const Keyframe& keyframe);
  void publish_cloud(const Keyframe& keyframe);
  void begin_octomap();
  void publish_octomap_part();
  void count_scans();
  void save_map_while_running();
  [[nodiscard]] std::error_code save_map(const std::filesystem::path& dir);

  node::Context& context_;
  Params params_;
  node::SensorInput input_;
  Slam6d slam_;
  OccupancyMap occupancy_;
  std::size_t counted_scans_ = 0;
  std::size_t counted_without_pose_ = 0;
  std::int64_t maps_saved_ = 0;
  OctomapParts octomap_;
  std::size_t octomap_keyframes_ = 0;  // in the map that was begun last
  std::int64_t octomap_utime_us_ = 0;  // of that map
  std::error_code save_error_;         // of the last try
};

}  // namespace nodmap::slam6d
