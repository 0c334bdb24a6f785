// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "common/geometry/time.hpp"

namespace nodmap::kurt {

/// Period at which the base sends its encoder ticks.
inline constexpr time::Duration kEncoderPeriod = 10ms;
inline constexpr double kEncoderPeriodS = time::seconds(kEncoderPeriod);

/// Estimates when an encoder frame was measured, and how many before it were lost, from the times
/// at which frames arrive; they contain neither a number nor a time.
///
/// Frames leave the base every 10 ms and arrive with a delay that varies (USB, scheduling) but is
/// never negative. So the smallest observed delay gives the base's clock (passive synchronization,
/// Olson 2010). After a late frame the next ones catch up; after a lost one all following frames
/// are late. A frame counts as lost when all frames of half a second are late by a whole period, or
/// already all of ten if so many were lost that they are 100 ms late.
class EncoderClock {
 public:
  struct Reading {
    time::SteadyTime measured;  ///< on the clock of the arrivals; strictly increasing
    int lost = 0;  ///< number of frames now known to have been lost, within the last second
    time::Duration
        gap{};  ///< if > 0: how long nothing was received; the motion meanwhile is unknown
  };

  /// Adds a frame that arrived at `arrival`.
  Reading take(time::SteadyTime arrival);

 private:
  [[nodiscard]] Reading begin(time::SteadyTime arrival);
  [[nodiscard]] int lost_in_window(time::SteadyTime arrival);

  bool started_ = false;
  time::SteadyTime last_arrival_;
  time::SteadyTime measured_;  // the best estimate; a frame with less delay moves it back
  time::SteadyTime told_;      // the last one returned; later ones must not be earlier
  time::Duration least_late_{};
  int in_window_ = 0;
};

}  // namespace nodmap::kurt
