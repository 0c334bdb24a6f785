// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/noncopyable.hpp>
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

/// The heights that count in a map (paper, III A), in metres above flat ground. The lower limit
/// rises with distance by what the pitch may be wrong, so that far floor stays floor; near the
/// robot only the fixed part is left.
struct HeightBand {
  double floor_m = 0.0;
  double floor_rise = 0.0;
  double ceiling_m = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool contains(double height_m, double distance_m) const {
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
  std::int64_t sweep = 0;  ///< counts the sweeps of the head
  /// The laser plane at the lowest and highest pitch of the last two sweeps; empty before.
  std::optional<SlantedPlane> lowest_plane;
  std::optional<SlantedPlane> highest_plane;
  double elapsed_s = 0.0;  ///< since the last scan
  double clock_s = 0.0;    ///< the sum of these
};

/// Steps 2 and 3 of the map update (paper, III B); step 1 is the same for every rule. Both keep the
/// size of the map and leave every point in the bin of its bearing.
class UpdateRule : boost::noncopyable {
 public:
  virtual ~UpdateRule() = default;

  /// Whether step 2 has anything to do while the robot is stationary. The paper skips it then.
  [[nodiscard]] virtual bool removes_while_stationary() const = 0;

  /// Step 2: obsolete points become dummies; returns how many.
  virtual std::size_t remove_obsolete(ExtendedScan& map, const HeightBand& band,
                                      const ScanView& view) = 0;

  /// Step 3: more relevant points of the scan replace stored ones.
  virtual void replace(ExtendedScan& map, const HeightBand& band, const ScanView& view) = 0;
};

/// Steps 2 and 3 as printed: every transformation ages every point, and only a nearer (farther)
/// measurement renews it.
///
/// The paper counts transformations, "e.g. 500, about 5 s". At its 75 scans a second 500 take
/// 6.7 s, so the authors' count was of odometry at 100 Hz. Here each transformation counts with the
/// time it spans: the same 5 s at every rate. While the robot is stationary nothing is transformed
/// and nothing ages.
class PaperRule final : public UpdateRule {
 public:
  explicit PaperRule(double expiry_s) : expiry_s_(expiry_s) {}

  [[nodiscard]] bool removes_while_stationary() const override { return false; }
  std::size_t remove_obsolete(ExtendedScan& map, const HeightBand& band,
                              const ScanView& view) override;
  void replace(ExtendedScan& map, const HeightBand& band, const ScanView& view) override;

 private:
  double expiry_s_;
};

[[nodiscard]] std::unique_ptr<UpdateRule> make_update_rule(const MapServerParams& params);

}  // namespace nodmap::map_server
