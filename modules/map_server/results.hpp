// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/drawing/image.hpp"
#include "common/robot/footprint.hpp"
#include "modules/map_server/extended_scan.hpp"

namespace nodmap::map_server {

/// Draws both maps around the robot: ahead is up, structure blue, obstacles red on top, a ring for
/// each metre (a darker one for each fifth), the body in the middle.
[[nodiscard]] drawing::Image draw_maps(const ExtendedScan& obstacles, const ExtendedScan& structure,
                                       const robot::Footprint& robot);

}  // namespace nodmap::map_server
