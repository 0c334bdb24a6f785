// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "modules/navigator/rolling_grid.hpp"

namespace nodmap::navigator {

/// How measurements count for a cell. A hit counts more than a beam that passes: a thin leg fills
/// only a part of its cell, and close before and above a sill beams meet the floor. In a sweep of a
/// fast robot only one line falls on a low sill.
namespace evidence {

inline constexpr std::uint8_t kHit = 4;
inline constexpr std::uint8_t kMost = 12;
/// Evidence from which on a cell counts as obstacle or hole. One hit suffices if it is clearly
/// above or below the floor, or if the beam beside it says the same; what may be noise needs two.
inline constexpr std::uint8_t kEnough = 5;
inline constexpr std::uint8_t kCertain = 6;
/// A point that exceeds the tolerance of the floor's height by this is certainly not floor, even
/// while a braking robot tilts by 0.6 degrees: 2 cm at 2 m.
inline constexpr double kCertainM = 0.03;

[[nodiscard]] inline std::uint8_t more(std::uint8_t evidence, bool is_certain) {
  return std::min<std::uint8_t>(
      kMost, static_cast<std::uint8_t>(evidence + (is_certain ? kCertain : kHit)));
}

[[nodiscard]] inline std::uint8_t less(std::uint8_t evidence) {
  return evidence == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(evidence - 1);
}

/// How much higher or lower than the floor the noise of its range makes a beam end, metres: four
/// standard deviations. `sinking` is the height that the beam loses per metre. Of steep beams,
/// which are less than a centimetre apart, hundreds meet the floor in each sweep, and two of them
/// in one cell may be off by two or three standard deviations; hardly ever by four.
[[nodiscard]] inline double range_noise_m(double sinking) {
  return 0.04 * sinking;
}

}  // namespace evidence

/// What is known of one cell of the ground.
struct LocalCell {
  std::uint8_t obstacle = 0;    ///< evidence of something the body would hit
  std::uint8_t hole = 0;        ///< evidence of a drop
  bool is_floor : 1 = false;    ///< seen, directly or between two beams that hit the floor
  bool is_assumed : 1 = false;  ///< not seen, but floor: the robot was set down there
  /// A beam passed through the floor, down to what may be a ramp, and floor has not been seen here
  /// since.
  bool may_be_ramp : 1 = false;
  std::int16_t low_cm = 0;  ///< lowest and highest measured point of the obstacle, in odom
  std::int16_t high_cm = 0;
  std::uint16_t scan = 0;        ///< the last one in which evidence changed
  std::uint16_t seen_at_dm = 0;  ///< travel at the last hit, see ObstacleMemory
  /// In tenths of a second: since when something has been hit here, again and again, and the last
  /// hit, see ObstacleMemory.
  std::uint16_t hit_since_ds = 0;
  std::uint16_t hit_at_ds = 0;

  [[nodiscard]] bool is_obstacle() const { return obstacle >= evidence::kEnough; }
  [[nodiscard]] bool is_hole() const { return hole >= evidence::kEnough; }
  /// Whether the obstacle is a contact, which no beam has shown.
  [[nodiscard]] bool is_contact() const { return low_cm > high_cm; }
  /// Whether beams have passed through an obstacle or a hole measured there before.
  [[nodiscard]] bool is_cleared() const { return scan != 0 && !is_obstacle() && !is_hole(); }

  void set_floor() {
    is_floor = true;
    is_assumed = false;
  }
};

using LocalGrid = RollingGrid<LocalCell>;

/// Rounds a height down to whole centimetres, as cells store it.
[[nodiscard]] inline std::int16_t to_centimetres(double height_m) {
  return static_cast<std::int16_t>(std::floor(std::clamp(100.0 * height_m, -3e4, 3e4)));
}

}  // namespace nodmap::navigator
