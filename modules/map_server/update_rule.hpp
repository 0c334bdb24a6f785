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

/// The heights of points that a map accepts (paper, III A), in metres above flat ground. The lower
/// limit rises with distance, to allow for the error of the pitch: otherwise distant floor would
/// become an obstacle.
struct HeightBand {
  double floor_m = 0.0;     ///< lower limit at distance 0
  double floor_rise = 0.0;  ///< rise of the lower limit, metres per metre of distance
  double ceiling_m = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool contains(double height_m, double distance_m) const {
    return height_m >= floor_m + floor_rise * distance_m && height_m <= ceiling_m;
  }
};

/// A measured point, and the bin of its bearing.
struct Hit {
  EgoPoint point;
  std::size_t bin = 0;
};

/// The newest scan as both maps need it for an update.
struct NewScan {
  std::span<const Hit> hits;
  ScanLine line;
  std::int64_t sweep = 0;  ///< number of the present sweep
  /// The laser plane at the lowest and highest pitch that both of the last two sweeps covered;
  /// empty before the second one.
  std::optional<SlantedPlane> lowest_plane;
  std::optional<SlantedPlane> highest_plane;
  double elapsed_s = 0.0;  ///< time since the last scan
  double clock_s = 0.0;    ///< time since the first scan: the sum of all elapsed_s
};

/// Steps 2 and 3 of the map update (paper, III B) for one map, whose heights the rule knows; step 1
/// is the same for every rule. Neither step changes the number of bins, and every point stays in
/// the bin of its bearing.
class UpdateRule : boost::noncopyable {
 public:
  virtual ~UpdateRule() = default;

  /// Whether step 2 also runs while the robot is stationary. The paper skips it then.
  [[nodiscard]] virtual bool removes_while_stationary() const = 0;

  /// Step 2: replaces obsolete points by dummies; returns their number.
  virtual std::size_t remove_obsolete(ExtendedScan& map, const NewScan& scan) = 0;

  /// Step 3: replaces stored points by more relevant points of the scan.
  virtual void replace(ExtendedScan& map, const NewScan& scan) = 0;
};

/// Steps 2 and 3 as in the paper: every transformation ages every point, and only a measurement
/// that replaces the point resets its age.
///
/// The paper expires points after a number of transformations, "e.g. 500, about 5 s". At its 75
/// scans per second 500 take 6.7 s, so the authors probably counted odometry at 100 Hz. Here a
/// transformation counts with the time since the last one, which gives 5 s at any rate. While the
/// robot is stationary nothing is transformed, so nothing ages.
class PaperRule final : public UpdateRule {
 public:
  PaperRule(const HeightBand& band, double expiry_s) : band_(band), expiry_s_(expiry_s) {}

  [[nodiscard]] bool removes_while_stationary() const override { return false; }
  std::size_t remove_obsolete(ExtendedScan& map, const NewScan& scan) override;
  void replace(ExtendedScan& map, const NewScan& scan) override;

 private:
  HeightBand band_;
  double expiry_s_;
};

[[nodiscard]] std::unique_ptr<UpdateRule> make_update_rule(const MapServerParams& params,
                                                           const HeightBand& band);

}  // namespace nodmap::map_server
