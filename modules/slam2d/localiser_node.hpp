// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "common/node/map_options.hpp"
#include "common/node/node.hpp"
#include "modules/slam2d/back_end/tracked_path.hpp"
#include "modules/slam2d/localise/localiser.hpp"
#include "modules/slam2d/map_publisher.hpp"
#include "modules/slam2d/messages.hpp"
#include "modules/slam2d/scan/level_scan_reader.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::slam2d {

/// Localises in a map that it reads and never changes: subscribes to SCAN and ODOMETRY, and
/// publishes POSE_2D, and the map as MAP_2D for the page, the explorer and the navigator.
class LocaliserNode : public node::Node {
 public:
  /// Throws formats::InputFileError for a map that cannot be read.
  LocaliserNode(node::Context& context, const Slam2dParams& params,
                const node::MapOptions& options);

  void finish() override;
  void write_results(const std::filesystem::path& dir) override;
  [[nodiscard]] nlohmann::json metrics() const override;
  [[nodiscard]] node::Health health() const override {
    return health_of(last_state_, input_.input().lacks_odometry());
  }

 private:
  void on_scan(const nodmap::scan_t& message);
  void on_structure_map(const nodmap::egomap_t& message);
  void add_level_scans();
  void add_scan(const LevelScan& scan);

  node::Context& context_;
  LevelScanReader input_;
  KnownMap map_;
  OccupancyGrid grid_;  // of map_
  MapPublisher map_publisher_;
  Localiser localiser_;
  time::Timestamp last_stamp_{};                 // of a scan that was used
  PoseState last_state_ = PoseState::kTracking;  // before it nothing is wrong
  Keyframe map_frame_;                           // never moves
  TrackedPath path_;                             // without the scans while it was lost
};

}  // namespace nodmap::slam2d
