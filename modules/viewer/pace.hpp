// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/geometry/time.hpp"

namespace nodmap::viewer {

/// How often clients are sent what is new. While the machine is busy it is ever less often, so that
/// pages (a browser that draws takes far more than this process does) leave the processors to the
/// robot; when there is room again, ever more often.
class Pace {
 public:
  /// From this share of all processors' time on the machine is busy; below the other there is room.
  static constexpr float kBusyShare = 0.9F;
  static constexpr float kRoomShare = 0.75F;
  /// Twice a second a page still shows where the robot is.
  static constexpr time::Duration kSlowest = 500ms;

  explicit Pace(time::Duration fastest) : fastest_(fastest), period_(fastest) {}

  /// The share of the processors' time that was used in the last second, 0 to 1.
  void note_load(float share);

  /// Whether clients are to be sent what is new now; then the next time is a period later.
  [[nodiscard]] bool is_due(time::SteadyTime now);

  [[nodiscard]] time::Duration period() const { return period_; }
  [[nodiscard]] bool is_slowed() const { return period_ > fastest_; }

 private:
  time::Duration fastest_;
  time::Duration period_;
  time::SteadyTime due_{};
};

}  // namespace nodmap::viewer
