// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sim/world/world.hpp"

namespace nodmap::sim::test {

/// A wall across the x axis, whose surface is `x_m` ahead of the origin; 10 m wide, 2 m high.
inline World wall_ahead(double x_m) {
  World world;
  world.objects.push_back({Box{{x_m + 0.05, 0.0, 1.0}, {0.1, 10.0, 2.0}, 0.0}});
  return world;
}

}  // namespace nodmap::sim::test
