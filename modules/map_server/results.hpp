// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/picture/image.hpp"
#include "common/robot/footprint.hpp"
#include "modules/map_server/extended_scan.hpp"

namespace nodmap::map_server {

/// Both maps as the robot has them, ahead being up: structure blue, obstacles red on top, the
/// robot's body in the middle, a ring for each metre (a darker one for each fifth).
[[nodiscard]] picture::Image draw_maps(const ExtendedScan& obstacles, const ExtendedScan& structure,
                                       const robot::Footprint& robot);

}  // namespace nodmap::map_server
