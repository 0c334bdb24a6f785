// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <system_error>

#include "common/geometry/time.hpp"
#include "common/node/background_job.hpp"
#include "common/node/map_options.hpp"
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

/// SCAN and ODOMETRY in, POSE_6D for each sweep, CLOUD for each keyframe, POSE_GRAPH_6D when the
/// graph has changed and OCTOMAP now and then out; SAVE_REQUEST writes the map. Sweeps are
/// registered, loops are closed and the occupancy map is kept beside the messages: a scan is
/// handled within microseconds.
///
/// In a saved map it carries on, or only localises: then nothing but poses and the clouds of that
/// map is published, and nothing of it is written.
class Slam6dNode : public node::Node {
 public:
  using Params = Slam6dParams;

  Slam6dNode(node::Context& context, const Params& params);
  /// In a saved map. Throws formats::InputFileError for one that cannot be read.
  Slam6dNode(node::Context& context, const Params& params, const node::MapOptions& options);

  void finish() override;
  void write_results(const std::filesystem::path& dir) override;
  [[nodiscard]] nlohmann::json metrics() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  void on_odometry(const nodmap::odometry_t& message);
  void on_scan(const nodmap::scan_t& message);
  void on_save_request(const nodmap::save_request_t& message);

  /// What became of the occupancy map beside the messages.
  struct MapWork {
    std::optional<std::string> bt_file = std::nullopt;         ///< to be published
    std::optional<std::error_code> save_error = std::nullopt;  ///< where it was to be saved
  };

  void register_sweep(PlacedSweep sweep);
  void answer(const std::optional<PoseUpdate>& update);
  void publish(const PoseUpdate& update);
  void publish_cloud(std::size_t k);
  void publish_restored_cloud();
  void publish_graph(time::Timestamp stamp);
  [[nodiscard]] bool has_moved(double min_motion_m) const;
  void update_map(double min_motion_m);
  [[nodiscard]] bool begin_octomap(time::Timestamp stamp);
  void answer(const std::optional<MapWork>& work);
  void publish_octomap_part();
  void count_scans();
  /// While neither job runs: it reads `slam_`.
  void start_saving();
  [[nodiscard]] std::error_code save_map(const std::filesystem::path& dir,
                                         const SavedMap& keyframes) const;

  node::Context& context_;
  Params params_;
  node::SensorInput input_;
  Slam6d slam_;
  bool only_localises_ = false;
  std::size_t restored_clouds_ = 0;  // published
  std::int64_t graph_revision_ = 0;  // published
  time::Timestamp graph_stamp_{};
  OccupancyMap occupancy_;
  /// Of the keyframes that are in it, or on their way into it, the poses with which they are.
  std::vector<geometry::SE3> T_map_mapped_;
  ScanCounts counted_;
  std::int64_t maps_saved_ = 0;
  OctomapParts octomap_;
  std::size_t octomap_keyframes_ = 0;  // in the map that was begun last
  time::Timestamp octomap_stamp_{};    // of that map
  std::error_code save_error_;         // of the last try
  int scans_until_saved_again_ = 0;    // after an error
  // Last: they end before what they work on. `registering_` works on `slam_`, `mapping_` on
  // `occupancy_`.
  node::BackgroundJob<PoseUpdate> registering_;
  node::BackgroundJob<MapWork> mapping_;
};

}  // namespace nodmap::slam6d
