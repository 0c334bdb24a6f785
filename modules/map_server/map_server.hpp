// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "common/robot/footprint.hpp"
#include "common/scan/scan.hpp"
#include "modules/map_server/ego_map.hpp"
#include "modules/map_server/params.hpp"
#include "modules/map_server/sweep_tracker.hpp"

namespace nodmap::map_server {

/// Whether a scan was used, or why not.
enum class ScanStatus : std::uint8_t { kUsed, kImplausibleScan, kImplausiblePose };

/// Maintains the paper's two egocentric maps (III A and B) and updates them with every scan. Does
/// not allocate memory after the first scan.
class MapServer {
 public:
  explicit MapServer(const MapServerParams& params);

  /// Updates both maps with a scan. `T_odom_base` is the odometry pose at the middle of the scan;
  /// its x, y and yaw move the maps. An implausible scan or pose leaves the maps unchanged.
  ScanStatus add_scan(const scan::Scan& scan, const geometry::SE3& T_odom_base);

  /// Clears both maps: to be called when odometry has restarted and the motion is unknown.
  void reset();

  [[nodiscard]] const EgoMap& obstacle_map() const { return obstacle_map_; }
  [[nodiscard]] const EgoMap& structure_map() const { return structure_map_; }

  /// Seconds since a point was last measured, from the stamps of the scans.
  [[nodiscard]] double age_s(const EgoPoint& point) const {
    return clock_s_ - point.confirmed_at_s;
  }

 private:
  [[nodiscard]] std::optional<geometry::SE2> pose_shift(const geometry::SE2& T_odom_base);
  [[nodiscard]] double advance_clock(time::Timestamp stamp);
  [[nodiscard]] NewScan new_scan_of(const scan::Scan& scan, double elapsed_s);
  void project(const scan::Scan& scan);

  robot::Footprint body_;
  EgoMap obstacle_map_;
  EgoMap structure_map_;
  scan::ScanProjector projector_;
  SweepTracker sweeps_;
  std::vector<Hit> hits_;
  std::optional<geometry::SE2> T_odom_last_;
  std::optional<time::Timestamp> last_stamp_;
  double clock_s_ = 0.0;  // sum of the times between scans; a stamp that steps back adds 0
};

}  // namespace nodmap::map_server
