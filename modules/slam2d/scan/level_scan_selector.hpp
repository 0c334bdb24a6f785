// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>

#include "common/scan/scan.hpp"
#include "modules/slam2d/params.hpp"

namespace nodmap::slam2d {

/// Whether the pitch is the same at the first and the last beam: the scanner does not nod.
[[nodiscard]] bool has_constant_pitch(const scan::Scan& scan);

/// Selects the scans taken in the horizontal position from the stream of a nodding scanner (section
/// IV A): of each sweep the one whose mean pitch is nearest to 0, at most half a pitch step away.
/// Selects every scan of a scanner that is held level.
class LevelScanSelector {
 public:
  explicit LevelScanSelector(const LevelScanParams& params) : params_(params) {}

  /// Takes the next scan. Returns the level scan as soon as it is known: this scan or the previous
  /// one. Otherwise null. Valid until the next call.
  [[nodiscard]] const scan::Scan* add(const scan::Scan& scan);

  /// The two scans before the one that add() has just returned. Null if the scanner is held level,
  /// or they have not come.
  [[nodiscard]] std::array<const scan::Scan*, 2> before() const;
  /// The scan after it, if it has come.
  [[nodiscard]] const scan::Scan* after() const {
    return current_was_used_ || is_held_ ? nullptr : &*current_;
  }

 private:
  [[nodiscard]] bool is_level(const scan::Scan& scan) const;
  [[nodiscard]] const scan::Scan* select(bool is_held, bool previous_was_used);

  LevelScanParams params_;
  std::array<std::optional<scan::Scan>, 2> older_;  // the newer one first
  std::optional<scan::Scan> previous_;
  std::optional<scan::Scan> current_;
  bool current_was_used_ = false;
  bool is_held_ = false;
};

}  // namespace nodmap::slam2d
