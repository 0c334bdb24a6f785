// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>

namespace nodmap::geometry {

inline constexpr double kPi = std::numbers::pi;

[[nodiscard]] constexpr double deg_to_rad(double angle_deg) {
  return angle_deg * (kPi / 180.0);
}
[[nodiscard]] constexpr double rad_to_deg(double angle_rad) {
  return angle_rad * (180.0 / kPi);
}

/// The equal angle in (-pi, pi]. The only place in the project that wraps an angle.
[[nodiscard]] inline double normalize_angle(double angle_rad) {
  if (std::abs(angle_rad) < kPi) {
    return angle_rad;  // mostly; a division takes longer
  }
  const double wrapped = std::remainder(angle_rad, 2.0 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

/// The shortest rotation from `from_rad` to `to_rad`, in (-pi, pi].
[[nodiscard]] inline double angle_difference(double to_rad, double from_rad) {
  return normalize_angle(to_rad - from_rad);
}

}  // namespace nodmap::geometry
