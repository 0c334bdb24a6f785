// SPDX-License-Identifier: BSD-3-Clause
// The wake of a person: where they are and were within the last second. Both maps may still have
// them there as obstacles: the obstacle map from earlier sweeps, the local map from before it was
// known that they walk. Only people in sight have a wake.
#pragma once

#include "modules/navigator/obstacle_points.hpp"
#include "modules/navigator/people/person.hpp"

namespace nodmap::navigator {

class LocalMap;

/// The points that are in nobody's wake. What gives way to people goes by their tracks, not by
/// points.
[[nodiscard]] Points without_wakes(const People& people_base, Points points_base);

/// Removes the obstacles in wakes from the local map.
void forget_wakes(const People& people_odom, LocalMap& local_map);

}  // namespace nodmap::navigator
