// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace nodmap::kurt {

/// How often the base sends its encoders.
inline constexpr std::int64_t kEncoderPeriodUs = 10'000;

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
    std::int64_t measured_us = 0;  ///< on the clock of the arrivals; goes up with every frame
    int lost = 0;             ///< frames found to be lost in the last half second, not long ago
    std::int64_t gap_us = 0;  ///< > 0: nothing came for so long that what happened is not known
  };

  /// A frame arrived. `arrival_us` is on a monotonic clock.
  Reading take(std::int64_t arrival_us);

  /// The line was lost: the next frame starts anew.
  void restart() { started_ = false; }

 private:
  [[nodiscard]] Reading begin(std::int64_t arrival_us);
  [[nodiscard]] int lost_in_window(std::int64_t arrival_us);

  bool started_ = false;
  bool begun_before_ = false;
  std::int64_t measured_us_ = 0;  // the best estimate, which a less delayed frame sets back
  std::int64_t told_us_ = 0;      // the last one told, which is never taken back
  std::int64_t least_late_us_ = 0;
  int in_window_ = 0;
};

}  // namespace nodmap::kurt
