// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace nodmap::navigator {

/// The floor as the beams of one scan have measured it. Neighbouring beams share errors of pitch
/// and tilt, so an object differs from the floor beside it by its true height, up to the noise of
/// two ranges, at any distance. This finds a brick of 3 cm that its height alone would not show.
class LineFloor {
 public:
  void begin_scan(std::size_t num_beams);

  /// A beam ended on the floor, or so little above or below that it may be floor. `height_m`: above
  /// the tracked ground.
  void add(std::size_t beam, double height_m);

  /// The height at which the beams within 25 places of this one measured the floor. It is the lower
  /// quartile, because some of them may have hit what stands on the floor. Empty if fewer than 12
  /// heights are known.
  [[nodiscard]] std::optional<double> level_around(std::size_t beam) const;

 private:
  std::vector<std::optional<double>> heights_m_;
};

}  // namespace nodmap::navigator
