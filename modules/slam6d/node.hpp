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
#include "modules/slam6d/occupancy_mapper.hpp"
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

  void register_sweep(PlacedSweep sweep);
  void answer(const std::optional<PoseUpdate>& update);
  void publish(const PoseUpdate& update);
  void publish_cloud(std::size_t k);
  void publish_restored_cloud();
  void publish_graph(time::Timestamp stamp);
  void answer_saved(const std::optional<std::error_code>& error);
  /// Returns whether there was one.
  bool publish_octomap_part();
  void count_scans();
  /// While neither job runs: it reads `slam_`.
  void start_saving();
  /// What saves the occupancy map with the keyframes of now.
  [[nodiscard]] OccupancyMapper::Save save_with_keyframes() const;
  [[nodiscard]] std::error_code save_map(const std::filesystem::path& dir, const OccupancyMap& map,
                                         const SavedMap& keyframes) const;

  node::Context& context_;
  Params params_;
  node::SensorInput input_;
  Slam6d slam_;
  bool only_localises_ = false;
  std::size_t restored_clouds_ = 0;  // published
  std::int64_t graph_revision_ = 0;  // published
  time::Timestamp graph_stamp_{};
  ScanCounts counted_;
  std::int64_t maps_saved_ = 0;
  std::error_code save_error_;       // of the last try
  int scans_until_saved_again_ = 0;  // after an error
  // Last: they end before what they work on. `registering_` works on `slam_`, `occupancy_` on
  // itself and on what save_map() uses.
  OccupancyMapper occupancy_;
  node::BackgroundJob<PoseUpdate> registering_;
};

}  // namespace nodmap::slam6d
