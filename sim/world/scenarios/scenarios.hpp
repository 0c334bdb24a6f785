// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "sim/world/world.hpp"

namespace nodmap::sim {

/// A family of worlds; the same seed gives the same world.
struct Scenario {
  std::string_view name;
  std::string_view summary;
  World (*make)(std::uint64_t seed);
};

/// All that there are, in the order of their names.
[[nodiscard]] std::span<const Scenario> scenarios();

/// A hall whose floor has stairs down, a shaft, a trench with a bridge, pits, a kerb of 8 cm or the
/// edge of a dock, by seed, between the start and a goal that can be reached around it.
[[nodiscard]] World make_holes(std::uint64_t seed);

}  // namespace nodmap::sim
