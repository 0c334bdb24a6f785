// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/time.hpp"

namespace nodmap::navigator {

/// Looks around where there is no path: after a second the robot rotates once, as far as it can,
/// and after half a minute without a path again.
class LookAround {
 public:
  /// There is no path. `yaw_rad`: the robot's heading in odom. Returns true when half a minute has
  /// passed and it begins again.
  bool step(time::Timestamp stamp, double yaw_rad);

  /// Whether the robot is to rotate.
  [[nodiscard]] bool wants_rotation() const;
  /// It cannot rotate any farther.
  void end();
  /// True once for each look around, when it is complete: the robot has rotated as far as it can.
  [[nodiscard]] bool take_end();

  /// There is a path. Without one, the robot rotates anew.
  void pause() { began_at_.reset(); }
  /// There is another goal.
  void reset() { *this = LookAround(); }

 private:
  std::optional<time::Timestamp> began_at_;
  time::Duration lasted_{};
  double last_yaw_rad_ = 0.0;
  double rotated_rad_ = 0.0;
  bool end_is_taken_ = false;
};

}  // namespace nodmap::navigator
