// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "common/drawing/drawn_point.hpp"
#include "modules/slam6d/slam6d.hpp"

namespace nodmap::slam6d {

/// The registered cloud: all measured points of the keyframes, in frame `map`. Points on something
/// that moved are left out.
[[nodiscard]] std::size_t num_registered(std::span<const Keyframe> keyframes);
[[nodiscard]] std::vector<Eigen::Vector3f> registered_points(const Keyframe& keyframe);

/// The registered cloud with the normals of its surfaces, for drawing. Of more than `max_points`
/// points only each second one is taken, each third one and so on.
[[nodiscard]] std::vector<drawing::DrawnPoint> drawn_cloud(std::span<const Keyframe> keyframes,
                                                           std::size_t max_points);

}  // namespace nodmap::slam6d
