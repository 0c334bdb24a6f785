// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/drawing/image.hpp"
#include "common/formats/tum.hpp"
#include "sim/world.hpp"
#include "tools/trial/record.hpp"

namespace nodmap::trial {

/// Where the robot believed to be, in the world.
struct EstimatedPath {
  formats::Trajectory poses;
  drawing::Rgb colour = drawing::kBlack;
};

/// The world from above with the way the robot took (dark blue, slow, to yellow, 1.5 m/s), its
/// collisions (red), and what was estimated. Obstacles are darker the higher they begin: light grey
/// stands on the floor.
[[nodiscard]] drawing::Image draw_paths(const sim::World& world, const TrialRecord& record,
                                        const std::vector<EstimatedPath>& estimates);

}  // namespace nodmap::trial
