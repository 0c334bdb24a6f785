// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/geometry/se3.hpp"

namespace nodmap::registration {

/// A correspondence of Eq. 3, w_ij = 1: point m_i of the model, point d_j of the data.
struct PointPair {
  Eigen::Vector3d p_model;
  Eigen::Vector3d p_data;
};

enum class FitStatus {
  kOk,
  kTooFewPairs,  ///< fewer than three
  kDegenerate    ///< on a line, in one point, or not finite: the rotation is not determined
};

struct RigidFit {
  FitStatus status = FitStatus::kTooFewPairs;
  geometry::SE3 T_model_data = geometry::SE3::Identity();  ///< identity unless kOk
};

/// Eq. 3 for n = 3 in closed form: the rotation and translation that make the sum of squared
/// distances of the pairs smallest (Arun, Huang, Blostein 1987; never a reflection: Umeyama 1991).
[[nodiscard]] RigidFit fit_rigid(std::span<const PointPair> pairs);

}  // namespace nodmap::registration
