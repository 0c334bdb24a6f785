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
#include "common/node/map_saving.hpp"
#include "common/node/message_counts.hpp"
#include "common/node/node.hpp"
#include "common/node/sensor_input.hpp"
#include "modules/slam6d/occupancy/occupancy_mapper.hpp"
#include "modules/slam6d/params.hpp"
#include "modules/slam6d/pose_update.hpp"
#include "modules/slam6d/slam6d.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/save_request_t.hpp"
#include "nodmap/scan_t.hpp"

namespace nodmap::slam6d {

/// The node around Slam6d. It receives SCAN and ODOMETRY. It publishes POSE_6D for each sweep,
/// CLOUD for each keyframe, POSE_GRAPH_6D when the graph has changed, and OCTOMAP every few
/// seconds while it changes. SAVE_REQUEST writes the map. Sweeps are registered, loops closed and
/// the occupancy map updated and saved on other threads, so that a scan is handled within
/// microseconds. Live, a scan waits for none of them, only a whole sweep for the registration of
/// the one before.
///
/// With a saved map the node either continues that map or only localises the robot in it. In the
/// second case it publishes poses and the clouds of that map, and does not write the map.
class Slam6dNode : public node::Node {
 public:
  using Params = Slam6dParams;

  /// Starts with the saved map of `options`, if one is given. Throws formats::InputFileError if it
  /// cannot be read.
  Slam6dNode(node::Context& context, const Params& params, const node::MapOptions& options = {});

  void finish() override;
  void write_results(const std::filesystem::path& dir) override;
  [[nodiscard]] nlohmann::json metrics() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  void restore(const node::MapOptions& options);
  void on_odometry(const nodmap::odometry_t& message);
  void on_scan(const nodmap::scan_t& message);
  void on_save_request(const nodmap::save_request_t& message);

  void save_when_idle();
  void save_unpolished();
  void register_sweep(PlacedSweep sweep);
  void answer(const std::optional<PoseUpdate>& update);
  void publish(const PoseUpdate& update);
  void publish_cloud(const Keyframe& keyframe);
  void publish_next_cloud();
  void publish_graph(time::Timestamp stamp);
  void answer_saved(const std::optional<std::error_code>& error);
  /// Returns whether there was a part to publish.
  bool publish_octomap_part();
  [[nodiscard]] bool is_outside_octree(const geometry::SE3& T_map_base) const;
  [[nodiscard]] std::string describe_outside(const geometry::SE3& T_map_base) const;
  void count_scans();
  /// Reads `slam_`; may be called only while neither job runs.
  void start_saving();
  /// The function that saves an occupancy map together with the present keyframes.
  [[nodiscard]] OccupancyMapper::Save save_with_keyframes() const;

  node::Context& context_;
  Params params_;
  node::SensorInput input_;
  node::MapSaving saving_;
  Slam6d slam_;
  bool only_localises_ = false;
  /// The keyframes whose clouds are still to be published: those of a saved map, or of one that
  /// began again. Ids.
  std::size_t next_cloud_id_ = 0;
  std::size_t clouds_end_id_ = 0;
  std::int64_t graph_revision_ = 0;             // last one published
  std::optional<time::Timestamp> graph_stamp_;  // of the last one
  ScanCounts counted_;
  bool lacks_odometry_ = false;   // for some scans of the last sweep
  time::Timestamp last_stamp_{};  // of SCAN
  std::optional<PoseUpdate> last_update_;
  bool has_warned_outside_ = false;  // of the octree
  std::int64_t maps_saved_ = 0;
  // These two are declared last, so that their threads end before the data they use are destroyed:
  // `registering_` uses `slam_`; `occupancy_` uses its own map and the folder for results.
  OccupancyMapper occupancy_;
  node::BackgroundJob<PoseUpdate> registering_;
};

}  // namespace nodmap::slam6d
