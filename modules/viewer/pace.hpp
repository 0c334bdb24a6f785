// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/time.hpp"

namespace nodmap::viewer {

/// Controls how often clients are updated. While the machine is busy, the period grows step by
/// step, so that pages leave the processors to the robot (a browser that draws needs far more time
/// than this process); when the machine is no longer busy, it shrinks again.
class Pace {
 public:
  /// The machine counts as busy from the first fraction of all processors' time on, and as free
  /// below the second.
  static constexpr float kBusyShare = 0.9F;
  static constexpr float kRoomShare = 0.75F;
  /// With two updates a second, a page still shows where the robot is.
  static constexpr time::Duration kSlowest = 500ms;

  explicit Pace(time::Duration fastest) : fastest_(fastest), period_(fastest) {}

  /// Takes the fraction of all processors' time that was used in the last second, 0 to 1.
  void note_load(float share);

  /// Returns true if clients must be updated now; the next update is then due one period later.
  [[nodiscard]] bool take_update(time::SteadyTime now);

  [[nodiscard]] time::Duration period() const { return period_; }
  [[nodiscard]] bool is_slowed() const { return period_ > fastest_; }

 private:
  time::Duration fastest_;
  time::Duration period_;
  time::SteadyTime due_{};
};

}  // namespace nodmap::viewer
