// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/scan/scan.hpp"

namespace nodmap::slam2d {

/// Picks the scans taken in the horizontal position out of the stream of a nodding scanner (section
/// IV A): of each half sweep the one with its pitch nearest to 0, so one for each time the pitch
/// passes 0. The nearest is never farther off than half a pitch step. A scanner that stands still
/// and level gives every scan.
class LevelScanSelector {
 public:
  explicit LevelScanSelector(double max_level_pitch_rad)
      : max_level_pitch_rad_(max_level_pitch_rad) {}

  /// Takes the next scan; returns the level one if this scan settles which it is: this scan itself
  /// or the one before. Valid until the next call.
  [[nodiscard]] const scan::Scan* add(const scan::Scan& scan);

 private:
  [[nodiscard]] bool is_level(const scan::Scan& scan) const;
  [[nodiscard]] const scan::Scan* select(bool stands, bool previous_was_used);

  double max_level_pitch_rad_;
  std::optional<scan::Scan> previous_;
  std::optional<scan::Scan> current_;
  bool current_was_used_ = false;
};

}  // namespace nodmap::slam2d
