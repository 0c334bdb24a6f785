// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/formats/tum.hpp"
#include "common/picture/image.hpp"
#include "sim/world/world.hpp"
#include "tools/trial/record.hpp"

namespace nodmap::trial {

/// Where the robot believed to be, in the world.
struct EstimatedPath {
  formats::Trajectory poses;
  picture::Rgb colour = picture::kBlack;
};

/// The world from above with the way the robot took (dark blue, slow, to yellow, 1.5 m/s), its
/// collisions (red), and what was estimated. Obstacles are darker the higher they begin: light grey
/// stands on the floor.
[[nodiscard]] picture::Image draw_paths(const sim::World& world, const TrialRecord& record,
                                        const std::vector<EstimatedPath>& estimates);

}  // namespace nodmap::trial
