// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::slam6d {

/// How the laser looks other than its pitch and the description of the robot say.
struct MountError {
  double pitch_rad = 0.0;  ///< it looks higher by this
  double roll_rad = 0.0;   ///< on its head, about its forward direction: its left side is higher

  [[nodiscard]] bool is_zero() const { return pitch_rad == 0.0 && roll_rad == 0.0; }
};

}  // namespace nodmap::slam6d
