// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/robot/footprint.hpp"
#include "modules/map_server/update_rule.hpp"

namespace nodmap::map_server {

/// Steps 2 and 3 with what the paper leaves open closed: a point lives for as long as the scanner
/// keeps finding it, goes when the scanner finds it gone, and stays when the scanner cannot tell.
///
/// Every stored point is compared with the scan line that crosses it:
/// - confirmed: the line of sight ends within max(3 sigma, 5 cm) of it. Its age starts anew (T5).
/// - contradicted: the beams on both sides of it, at a height at which it was met, go on for more
///   than 3 sigma + 5 cm. It goes when that happened in two sweeps, and at all of its heights,
///   without a confirmation in between; also while the robot stands (T3).
/// - neither, for instance hidden: it ages, by message time, and goes after `expiry_s`, but not
///   before the scanner has looked for it in two whole passes: a nod through all of its 120 degrees
///   takes longer than that (R12), and meets a point once.
/// - out of view, because the fan does not reach its bearing or the nod not its heights: nothing
///   happens to it (T4). A low box before the wheels is remembered for as long as it is there.
class ConfirmedRule final : public UpdateRule {
 public:
  explicit ConfirmedRule(const MapServerParams& params);

  [[nodiscard]] bool removes_while_standing() const override { return true; }
  std::size_t remove_obsolete(ExtendedScan& map, const HeightGate& gate,
                              const ScanView& view) override;
  void replace(ExtendedScan& map, const HeightGate& gate, const ScanView& view) override;

 private:
  [[nodiscard]] bool is_obsolete(EgoPoint& point, const ExtendedScan& map, const HeightGate& gate,
                                 const ScanView& view) const;
  [[nodiscard]] bool is_met(const ScanView& view, const ScanLine::Look& look) const;
  [[nodiscard]] bool is_in_view(const EgoPoint& point, Relevance relevance,
                                const ScanView& view) const;
  [[nodiscard]] bool spans(const EgoPoint& point, double lowest_m, double highest_m) const;
  [[nodiscard]] bool is_at_its_heights(const EgoPoint& point, const ScanLine::Look& look) const;
  void note_passing_beams(EgoPoint& point, const ScanView& view, const ScanLine::Look& look) const;
  [[nodiscard]] bool is_gone(const EgoPoint& point) const;
  [[nodiscard]] bool has_expired(const EgoPoint& point, const ScanView& view) const;
  static void confirm(EgoPoint& point, double height_m, const ScanView& view);

  double expiry_s_;
  double agreement_m_;         // readings this near are of the same surface
  double passing_m_;           // beams that go this far beyond have passed
  double height_tolerance_m_;  // heights this near are of the same part of an object
  int misses_to_remove_;
  robot::Footprint robot_;
};

}  // namespace nodmap::map_server
