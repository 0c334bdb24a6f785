// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "modules/map_server/update_rule.hpp"

namespace nodmap::map_server {

/// Steps 2 and 3 as printed: every transformation ages every point, and only a nearer (farther)
/// measurement renews it.
///
/// The paper counts transformations, "e.g. 500, about 5 s". At its 75 scans a second that would be
/// 6.7 s, so the count was of odometry at 100 Hz. Each transformation counts here with the time it
/// spans: the same 5 s at every rate. While the robot stands nothing is transformed or ages.
class PaperRule final : public UpdateRule {
 public:
  explicit PaperRule(double expiry_s) : expiry_s_(expiry_s) {}

  [[nodiscard]] bool removes_while_standing() const override { return false; }
  std::size_t remove_obsolete(ExtendedScan& map, const HeightGate& gate,
                              const ScanView& view) override;
  void replace(ExtendedScan& map, const HeightGate& gate, const ScanView& view) override;

 private:
  double expiry_s_;
};

}  // namespace nodmap::map_server
