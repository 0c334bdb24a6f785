// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "sim/world/world.hpp"

namespace nodmap::sim {

/// A walled room of 10 m x 10 m with the robot in its middle and 25 to 40 obstacles that are hard
/// to see: low and small (from 3 cm on, just higher than the robot can drive over), high (table
/// tops at 70 cm, under which the robot fits, and boards at 30 cm to 45 cm, under which it does
/// not), thin (legs of 3 cm). Nothing is nearer than 0.6 m to the start, and passages between
/// obstacles, or an obstacle and a wall, are 0.6 m wide or more: 4 cm more than the robot's
/// diagonal. The same seed gives the same world.
[[nodiscard]] World random_clutter(std::uint64_t seed);

/// The same with 40 to 60 obstacles and passages from 0.5 m on, in which the robot fits but cannot
/// rotate.
[[nodiscard]] World dense_clutter(std::uint64_t seed);

/// Dense clutter with a random start and a goal at least 6 m from it, both at places where the
/// robot can rotate. A disc of 0.5 m can reach every goal. Throws std::runtime_error if there are
/// no such places.
[[nodiscard]] World clutter_with_goal(std::uint64_t seed);

/// Fewer obstacles, and a goal with a heading: a station is 12 cm ahead of the body there, and the
/// last 0.8 m to it are free. Throws std::runtime_error if the clutter has no place for it.
[[nodiscard]] World clutter_with_dock(std::uint64_t seed);

}  // namespace nodmap::sim
