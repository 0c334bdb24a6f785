// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "common/robot/footprint.hpp"
#include "modules/map_server/update_rule.hpp"

namespace nodmap::map_server {

/// Steps 2 and 3 by visibility: keeps a point while the scanner measures it or cannot see it, and
/// removes it when beams pass through it.
///
/// Compares every stored point with the scan line that crosses it. The point is
/// - confirmed if the measured range ends within max(3 sigma, 5 cm) of it: its age is reset.
/// - contradicted if the beams on both sides of it, at a height at which it was measured, end more
///   than 3 sigma + 5 cm beyond it. It is removed when this has happened in `misses_to_remove`
///   sweeps and at all of its heights, without a confirmation in between, also while the robot is
///   stationary.
/// - undecided otherwise, for instance occluded: it ages, by message time, and is removed after
///   `expiry_s`, but not before two complete sweeps. (A sweep of 500 scans takes longer than
///   `expiry_s` and crosses each point once.)
/// - out of view if its bearing is outside the field of view, or its heights are outside what the
///   sweeps cover: it does not change. A low box right in front of the wheels is therefore
///   remembered.
class VisibilityRule final : public UpdateRule {
 public:
  VisibilityRule(const UpdateParams& params, const HeightBand& band, double range_sigma_m,
                 const robot::Footprint& body);

  [[nodiscard]] bool removes_while_stationary() const override { return true; }
  std::size_t remove_obsolete(ExtendedScan& map, const NewScan& scan) override;
  void replace(ExtendedScan& map, const NewScan& scan) override;

 private:
  /// Confirms, contradicts or ages a point; returns whether it is obsolete now.
  [[nodiscard]] bool examine(EgoPoint& point, const ExtendedScan& map, const NewScan& scan) const;
  [[nodiscard]] bool is_measured_again(const NewScan& scan,
                                       const ScanLine::Crossing& crossing) const;
  [[nodiscard]] bool is_in_view(const EgoPoint& point, Relevance relevance,
                                const NewScan& scan) const;
  [[nodiscard]] bool spans(const EgoPoint& point, double lowest_m, double highest_m) const;
  [[nodiscard]] bool is_at_its_heights(const EgoPoint& point,
                                       const ScanLine::Crossing& crossing) const;
  void note_passing_beams(EgoPoint& point, const NewScan& scan,
                          const ScanLine::Crossing& crossing) const;
  [[nodiscard]] bool is_contradicted(const EgoPoint& point) const;
  [[nodiscard]] bool has_expired(const EgoPoint& point, const NewScan& scan) const;
  static void confirm(EgoPoint& point, double height_m, const NewScan& scan);

  UpdateParams params_;
  HeightBand band_;
  double same_surface_m_;        // readings closer together than this are of the same surface
  double passing_m_;             // beams that reach this far beyond a point have passed it
  robot::Footprint inner_body_;  // the body without an outer margin for the odometry error
};

}  // namespace nodmap::map_server
