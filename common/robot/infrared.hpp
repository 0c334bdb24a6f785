// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/geometry/angle.hpp"
#include "common/geometry/se2.hpp"

namespace nodmap::robot {

/// The base's infrared range finders, in the order of base_sensors_t: counter-clockwise from the
/// front.
enum class Infrared : std::uint8_t {
  kLeftFront,
  kLeft,
  kLeftBack,
  kBack,
  kRightBack,
  kRight,
  kRightFront,
};
inline constexpr std::size_t kInfraredCount = 7;

/// The pose of each range finder in base, metres; it measures along its x axis.
inline constexpr std::array<geometry::SE2, kInfraredCount> kInfraredMounts{{
    {0.203, 0.153, geometry::deg_to_rad(45.0)},
    {0.0, 0.165, geometry::deg_to_rad(90.0)},
    {-0.203, 0.153, geometry::deg_to_rad(135.0)},
    {-0.217, 0.0, geometry::deg_to_rad(180.0)},
    {-0.203, -0.153, geometry::deg_to_rad(-135.0)},
    {0.0, -0.165, geometry::deg_to_rad(-90.0)},
    {0.203, -0.153, geometry::deg_to_rad(-45.0)},
}};

[[nodiscard]] constexpr const geometry::SE2& mount_of(Infrared sensor) {
  return kInfraredMounts[static_cast<std::size_t>(sensor)];
}

}  // namespace nodmap::robot
