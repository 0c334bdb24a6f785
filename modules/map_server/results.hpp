// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/drawing/image.hpp"
#include "common/robot/footprint.hpp"
#include "modules/map_server/extended_scan.hpp"

namespace nodmap::map_server {

/// Draws both maps around the robot's body: ahead is up, structure is blue, obstacles are red and
/// on top. There is a ring every metre, and a darker one every five metres.
[[nodiscard]] drawing::Image draw_maps(const ExtendedScan& obstacles, const ExtendedScan& structure,
                                       const robot::Footprint& robot);

}  // namespace nodmap::map_server
