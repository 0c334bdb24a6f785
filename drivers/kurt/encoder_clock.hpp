// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "common/geometry/time.hpp"

namespace nodmap::kurt {

/// How often the base sends its encoders.
inline constexpr time::Duration kEncoderPeriod = 10ms;

/// Estimates when an encoder frame was measured, and how many before it were lost, from the times
/// at which frames arrive; they carry neither number nor time.
///
/// Frames leave the base every 10 ms and arrive with a delay that varies (USB, scheduling) but is
/// never negative. So the smallest delay seen gives the base's clock (passive synchronization,
/// Olson 2010). A delay passes, a loss stays: after a late frame the next ones catch up, after a
/// lost one all of them are late. A frame counts as lost when all frames of half a second are late
/// by a whole period.
class EncoderClock {
 public:
  struct Reading {
    time::SteadyTime measured;  ///< on the clock of the arrivals; goes up with every frame
    int lost = 0;               ///< frames found to be lost in the last half second, not long ago
    time::Duration gap{};       ///< > 0: nothing came for so long that what happened is not known
  };

  /// A frame arrived. `arrival` is on a monotonic clock.
  Reading take(time::SteadyTime arrival);

  /// The line was lost: the next frame starts anew.
  void restart() { started_ = false; }

 private:
  [[nodiscard]] Reading begin(time::SteadyTime arrival);
  [[nodiscard]] int lost_in_window(time::SteadyTime arrival);

  bool started_ = false;
  bool begun_before_ = false;
  time::SteadyTime measured_;  // the best estimate, which a less delayed frame sets back
  time::SteadyTime told_;      // the last one told, which is never taken back
  time::Duration least_late_{};
  int in_window_ = 0;
};

}  // namespace nodmap::kurt
