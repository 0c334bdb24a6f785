// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "common/drawing/plan_view.hpp"
#include "common/formats/tum.hpp"
#include "sim/world/world.hpp"
#include "tools/trial/record.hpp"

namespace nodmap::trial {

/// A trajectory estimated by one of the modules, in the map frame.
struct EstimatedPath {
  std::string name;
  formats::Trajectory poses;
  drawing::Rgb colour;
};

/// The world from above with the robot's true path (dark blue: slow, yellow: 1.5 m/s), its
/// collisions (red) and the estimated paths. The brightness of obstacles shows the height at which
/// they begin: light grey ones stand on the floor, darker ones begin higher.
[[nodiscard]] drawing::Image draw_paths(const sim::World& world, const TrialRecord& record,
                                        const std::vector<EstimatedPath>& estimates);

}  // namespace nodmap::trial
