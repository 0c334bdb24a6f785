// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "common/drawing/drawn_point.hpp"
#include "modules/slam6d/slam6d.hpp"

namespace nodmap::slam6d {

/// All measured points of the keyframes, in frame `map`, each with the normal of its surface.
/// Points on something that moved are left out.
[[nodiscard]] std::vector<drawing::DrawnPoint> registered_cloud(
    std::span<const Keyframe> keyframes);

}  // namespace nodmap::slam6d
