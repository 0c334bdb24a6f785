// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "modules/map_server/extended_scan.hpp"
#include "modules/map_server/params.hpp"
#include "modules/map_server/scan_line.hpp"

namespace nodmap::map_server {

/// The heights that matter to a map (III A), in metres above flat ground (R14). The floor rises
/// with distance by what the pitch may be wrong, so that far floor stays floor; where an obstacle
/// comes near, only the fixed part is left.
struct HeightGate {
  double floor_m = 0.0;
  double floor_rise = 0.0;
  double ceiling_m = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool admits(double height_m, double distance_m) const {
    return height_m >= floor_m + floor_rise * distance_m && height_m <= ceiling_m;
  }
};

/// A measured point and the bin in which the base sees it.
struct Hit {
  EgoPoint point;
  std::size_t bin = 0;
};

/// What one update knows of the new scan, the same for both maps.
struct ScanView {
  std::span<const Hit> hits;
  ScanLine line;
  std::int64_t pass = 0;  ///< counts the sweeps from turning point to turning point
  /// The laser plane at the lowest and highest pitch that the last sweeps reached; empty before two
  /// sweeps are done.
  std::optional<SlantedPlane> lowest_plane;
  std::optional<SlantedPlane> highest_plane;
  double elapsed_s = 0.0;  ///< since the last scan
  double clock_s = 0.0;    ///< the sum of these
};

/// Steps 2 and 3 of the map update (III B); step 1 is the same for every rule. Both keep the size
/// of the map and leave every point in the bin of its bearing.
class UpdateRule {
 public:
  UpdateRule() = default;
  UpdateRule(const UpdateRule&) = delete;
  UpdateRule& operator=(const UpdateRule&) = delete;
  UpdateRule(UpdateRule&&) = delete;
  UpdateRule& operator=(UpdateRule&&) = delete;
  virtual ~UpdateRule() = default;

  /// Whether step 2 has anything to do while the robot stands. The paper skips it then.
  [[nodiscard]] virtual bool removes_while_standing() const = 0;

  /// Step 2: obsolete points become dummies; returns how many.
  virtual std::size_t remove_obsolete(ExtendedScan& map, const HeightGate& gate,
                                      const ScanView& view) = 0;

  /// Step 3: points give way to more relevant ones of the scan.
  virtual void replace(ExtendedScan& map, const HeightGate& gate, const ScanView& view) = 0;
};

[[nodiscard]] std::unique_ptr<UpdateRule> make_update_rule(const MapServerParams& params);

}  // namespace nodmap::map_server
