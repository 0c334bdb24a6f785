// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <system_error>

#include "common/geometry/time.hpp"
#include "common/node/background_job.hpp"
#include "common/node/map_options.hpp"
#include "common/node/map_saving.hpp"
#include "common/node/node.hpp"
#include "modules/slam2d/grid/keyframe_grid.hpp"
#include "modules/slam2d/map_publisher.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/scan/level_scan_reader.hpp"
#include "modules/slam2d/slam2d.hpp"
#include "nodmap/clear_request_t.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::slam2d {

/// Runs 2D SLAM: subscribes to SCAN and ODOMETRY, and publishes POSE_2D, MAP_2D and POSE_GRAPH.
/// Saves the map at SAVE_REQUEST and clears a region of it at CLEAR_REQUEST. Loops are closed on a
/// thread of their own. Live, no scan waits until the map is on the disk.
class Slam2dNode : public node::Node {
 public:
  using Params = Slam2dParams;

  /// Continues the map in `options.map_in`, or begins a new one without it. Throws
  /// formats::InputFileError if that map cannot be read.
  Slam2dNode(node::Context& context, const Params& params, const node::MapOptions& options = {});

  void finish() override;
  void write_results(const std::filesystem::path& dir) override;
  [[nodiscard]] nlohmann::json metrics() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  void on_scan(const nodmap::scan_t& message);
  void on_structure_map(const nodmap::egomap_t& message);
  void add_level_scans();
  void add_scan(const LevelScan& scan);
  void on_clear_request(const nodmap::clear_request_t& message);
  void on_save_request(const nodmap::save_request_t& message);
  void continue_map(const node::MapOptions& options);
  void save_if_due();
  void save_unpolished();
  void answer_saved(const std::optional<std::error_code>& error);
  /// The function that writes the map, as it is now, into a folder. It may run on another thread.
  [[nodiscard]] std::function<std::error_code()> prepare_save(const std::filesystem::path& dir);
  void update_grid();
  void drop_from_grid();
  void publish_graph(time::Timestamp stamp);

  node::Context& context_;
  LevelScanReader input_;
  Slam2d slam_;
  KeyframeGrid map_;
  MapPublisher map_publisher_;
  time::Timestamp last_stamp_{};  // of a scan that was used
  std::optional<time::Timestamp> last_graph_stamp_;
  std::int64_t graph_revision_published_ = 0;
  PoseState last_state_ = PoseState::kTracking;
  node::MapSaving saving_;
  node::BackgroundJob<std::error_code> writing_;  // a copy of the map
};

}  // namespace nodmap::slam2d
