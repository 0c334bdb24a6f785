// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/robot/footprint.hpp"
#include "modules/map_server/update_rule.hpp"

namespace nodmap::map_server {

/// Steps 2 and 3 by visibility: a point is kept for as long as the scanner keeps measuring it,
/// removed when the scanner sees through its place, and kept when the scanner cannot tell.
///
/// Every stored point is compared with the scan line that crosses it:
/// - confirmed: the line of sight ends within max(3 sigma, 5 cm) of it. Its age starts anew.
/// - contradicted: the beams on both sides of it, at a height at which it was measured, reach more
///   than 3 sigma + 5 cm beyond. It is removed when that happened in two sweeps, and at all of its
///   heights, without a confirmation in between; also while the robot is stationary.
/// - neither, for instance occluded: it ages, by message time, and is removed after `expiry_s`, but
///   not before the scanner has looked for it in two whole sweeps: at 500 scans a sweep takes
///   longer than that, and crosses a point once.
/// - out of view, because the fan does not reach its bearing or the sweeps not its heights: it is
///   left unchanged. A low box before the wheels is remembered for as long as it is there.
class VisibilityRule final : public UpdateRule {
 public:
  VisibilityRule(const UpdateParams& params, double range_sigma_m, const robot::Footprint& body);

  [[nodiscard]] bool removes_while_stationary() const override { return true; }
  std::size_t remove_obsolete(ExtendedScan& map, const HeightBand& band,
                              const ScanView& view) override;
  void replace(ExtendedScan& map, const HeightBand& band, const ScanView& view) override;

 private:
  [[nodiscard]] bool is_obsolete(EgoPoint& point, const ExtendedScan& map, const HeightBand& band,
                                 const ScanView& view) const;
  [[nodiscard]] bool is_measured_again(const ScanView& view,
                                       const ScanLine::Crossing& crossing) const;
  [[nodiscard]] bool is_in_view(const EgoPoint& point, Relevance relevance,
                                const ScanView& view) const;
  [[nodiscard]] bool spans(const EgoPoint& point, double lowest_m, double highest_m) const;
  [[nodiscard]] bool is_at_its_heights(const EgoPoint& point,
                                       const ScanLine::Crossing& crossing) const;
  void note_passing_beams(EgoPoint& point, const ScanView& view,
                          const ScanLine::Crossing& crossing) const;
  [[nodiscard]] bool is_contradicted(const EgoPoint& point) const;
  [[nodiscard]] bool has_expired(const EgoPoint& point, const ScanView& view) const;
  static void confirm(EgoPoint& point, double height_m, const ScanView& view);

  UpdateParams params_;
  double same_surface_m_;        // readings this near are of the same surface
  double passing_m_;             // beams that reach this far beyond have passed
  robot::Footprint inner_body_;  // without the skin that odometry's error may reach into
};

}  // namespace nodmap::map_server
