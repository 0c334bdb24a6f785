// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace nodmap::slam6d {

/// How level the ground is, where it is level: standard deviations of the base's height and of its
/// roll and pitch.
struct LevelGround {
  double height_sigma_m;
  double tilt_sigma_rad;
};

}  // namespace nodmap::slam6d
