// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/drawing/image.hpp"
#include "modules/map_server/extended_scan.hpp"
#include "modules/map_server/footprint.hpp"

namespace nodmap::map_server {

/// Both maps as the robot has them, ahead being up: structure blue, obstacles red on top, the
/// robot's body in the middle, a ring for each metre (a darker one for each fifth).
[[nodiscard]] drawing::Image draw_maps(const ExtendedScan& obstacles, const ExtendedScan& structure,
                                       const Footprint& robot);

}  // namespace nodmap::map_server
