// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "sim/world/world.hpp"

namespace nodmap::sim {

/// A family of worlds; the same seed gives the same world.
struct Scenario {
  std::string_view name;
  std::string_view summary;
  World (*make)(std::uint64_t seed);
};

/// All scenarios, in the order of their names.
[[nodiscard]] std::span<const Scenario> scenarios();

/// Their names, as in a message: "building, corridor, ...".
[[nodiscard]] std::string scenario_names();

/// A hall whose floor has stairs down, a shaft, a trench with a bridge, pits, a kerb of 8 cm or the
/// edge of a dock, by seed, between the start and a goal that can be reached around it.
[[nodiscard]] World make_holes(std::uint64_t seed);

/// A maze of 4 to 6 by 4 to 5 cells of 1.0 to 1.4 m, with loops; the goal in the opposite corner.
[[nodiscard]] World make_maze(std::uint64_t seed);
/// A corridor with baffles that leave 0.6 to 0.9 m, alternately on each side.
[[nodiscard]] World make_zigzag(std::uint64_t seed);
/// A dead end 0.7 m wide between start and goal; with every other seed the robot starts in it.
[[nodiscard]] World make_dead_end(std::uint64_t seed);
/// The robot starts in a slot 10 to 17 cm wider than its body, or in the corner of a hall.
[[nodiscard]] World make_slot(std::uint64_t seed);
/// Two or three rooms; doors of 0.55 to 0.60 m, 1.6 to 2.3 m aside of the straight line.
[[nodiscard]] World make_doors(std::uint64_t seed);
/// Ten rooms on a corridor, with a goal in one of them; and the same without, to explore.
[[nodiscard]] World make_office(std::uint64_t seed);
[[nodiscard]] World make_building(std::uint64_t seed);
/// A corridor of 100 m with objects along its walls and boxes of 10 cm on its floor.
[[nodiscard]] World make_corridor(std::uint64_t seed);

/// Sills and planks of 3.1 to 6 cm across the path, higher than the robot can drive over.
[[nodiscard]] World make_sills(std::uint64_t seed);
/// Panes of glass, which return no light, across the path; only their posts are seen.
[[nodiscard]] World make_glass(std::uint64_t seed);
/// A pane of glass that lies as a table top across the path, in a furnished hall.
[[nodiscard]] World make_contact(std::uint64_t seed);
/// Rows of drums of 12 and 16 cm with gaps of 0.55 to 0.75 m.
[[nodiscard]] World make_drums(std::uint64_t seed);
/// Ramps of 5, 10 and 12 degrees (seed % 3): up to a platform, over a hill, or down (seed / 3 % 3).
[[nodiscard]] World make_ramps(std::uint64_t seed);

/// 4 to 8 people who cross, come towards the robot or overtake it at 0.5 to 2 m/s, or one every 3
/// to 5 s through a corridor (seed % 3 == 2). They do not react.
[[nodiscard]] World make_people(std::uint64_t seed);
/// The same with people who make way.
[[nodiscard]] World make_reacting_people(std::uint64_t seed);

}  // namespace nodmap::sim
