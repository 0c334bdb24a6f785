// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "common/drawing/drawn_point.hpp"
#include "modules/slam6d/slam6d.hpp"

namespace nodmap::slam6d {

/// The points of all keyframes as they were measured, in map, with the normals of their surfaces;
/// without those that moved.
[[nodiscard]] std::vector<drawing::DrawnPoint> registered_cloud(
    std::span<const Keyframe> keyframes);

}  // namespace nodmap::slam6d
