// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "common/geometry/se3.hpp"

namespace nodmap::registration {

/// A correspondence of Eq. 3 with the weight w_ij = 1: a point m_i of the model and a point d_j of
/// the data, metres.
struct PointPair {
  Eigen::Vector3d p_model;
  Eigen::Vector3d p_data;
};

/// Solves Eq. 3 for n = 3 in closed form: finds the rotation and translation for which the sum of
/// the squared distances of the pairs is smallest (Arun, Huang, Blostein 1987). The result,
/// T_model_data, is never a reflection (Umeyama 1991). Empty if no rotation is determined, because
/// the points are on a line, coincide or are not finite.
[[nodiscard]] std::optional<geometry::SE3> fit_rigid(std::span<const PointPair> pairs);

}  // namespace nodmap::registration
