// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/registration/pose_graph.hpp"
#include "modules/slam6d/pose_covariance.hpp"

namespace nodmap::slam6d {

/// The inverse of an information matrix; finite also along degenerate directions, where it is very
/// large.
[[nodiscard]] Matrix6d covariance_of(const Matrix6d& information);

/// The size of a covariance as one number, m^2: the variance of the position plus that of a point 5
/// m away due to the orientation.
[[nodiscard]] double size_of(const Matrix6d& covariance);

/// The edge along two others, from `a` to `b` to `c`. Their covariances are added, each at the end
/// of its moment arm.
[[nodiscard]] registration::PoseEdge3d composed(const registration::PoseEdge3d& a_b,
                                                const registration::PoseEdge3d& b_c);

/// The same edge in the opposite direction.
[[nodiscard]] registration::PoseEdge3d reversed(const registration::PoseEdge3d& edge);

}  // namespace nodmap::slam6d
