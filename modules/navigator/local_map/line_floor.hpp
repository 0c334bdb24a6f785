// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace nodmap::navigator {

/// The floor as the beams of one scan have measured it. Errors of pitch and tilt are the same for
/// neighbouring beams: an object is higher than the floor beside it by its true height and the
/// noise of two ranges, at any distance. So a brick of 3 cm is found where the heights themselves
/// would not show it.
class LineFloor {
 public:
  void begin_scan(std::size_t num_beams);

  /// A beam ended on the floor, or so near to its height that it may be the floor. `height_m`:
  /// above the tracked ground.
  void add(std::size_t beam, double height_m);

  /// The height at which the beams within 25 places of this one measured the floor: the lower
  /// quartile, for part of them may have hit what stands on it. Empty where fewer than 12 are
  /// known.
  [[nodiscard]] std::optional<double> level_around(std::size_t beam) const;

 private:
  std::vector<std::optional<double>> heights_m_;
};

}  // namespace nodmap::navigator
