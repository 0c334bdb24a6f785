// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>

namespace nodmap::slam6d {

/// The unit normal, in either direction, of the plane on which points with this covariance lie: the
/// eigenvector of the smallest eigenvalue. Empty if the smallest eigenvalue is not below
/// `max_thickness` times the middle one, or equals it, to rounding. For points on a line, on which
/// many planes lie, there may be a direction, which means nothing.
[[nodiscard]] std::optional<Eigen::Vector3f> plane_normal(const Eigen::Matrix3f& covariance,
                                                          float max_thickness);

}  // namespace nodmap::slam6d
