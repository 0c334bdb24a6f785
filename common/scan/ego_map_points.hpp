// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace nodmap::scan {

/// Reads the points of an egocentric map, in base and metres, in the order of its bins (distance, x
/// and y), as in nodmap.egomap_t. A direction without a point has the distance +infinity. Empty if
/// distance and point of any bin disagree: a map that is wrong in one place is not used at all.
[[nodiscard]] std::optional<std::vector<Eigen::Vector2d>> read_ego_map_points(
    std::span<const float> distance_m, std::span<const float> x_m, std::span<const float> y_m);

}  // namespace nodmap::scan
