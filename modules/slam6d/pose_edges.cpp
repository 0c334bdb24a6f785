// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/pose_edges.hpp"

#include <algorithm>

namespace nodmap::slam6d {

using registration::PoseEdge3d;
namespace {

// The inverse of covariance_of(): directions that were unknown are unknown again.
Matrix6d information_of(const Matrix6d& covariance) {
  constexpr double kUnknown = 1e4;  // covariance_of() gives 1e6 for a degenerate direction
  const auto [values, vectors] =
      registration::eigensystem(0.5 * (covariance + covariance.transpose()));
  Vector6d information = Vector6d::Zero();
  for (int k = 0; k < 6; ++k) {
    const double variance = values[k];
    information[k] = variance < kUnknown ? 1.0 / std::max(variance, 1e-9) : 0.0;
  }
  return vectors * information.asDiagonal() * vectors.transpose();
}

}  // namespace

Matrix6d covariance_of(const Matrix6d& information) {
  return registration::inverse(information + 1e-6 * Matrix6d::Identity());
}

double size_of(const Matrix6d& covariance) {
  constexpr double kMomentArmM = 5.0;
  return covariance.topLeftCorner<3, 3>().trace() +
         kMomentArmM * kMomentArmM * covariance.bottomRightCorner<3, 3>().trace();
}

PoseEdge3d composed(const PoseEdge3d& a_b, const PoseEdge3d& b_c) {
  PoseEdge3d edge{.from = a_b.from,
                  .to = b_c.to,
                  .T_from_to = a_b.T_from_to * b_c.T_from_to,
                  .may_be_wrong = a_b.may_be_wrong || b_c.may_be_wrong};
  const Matrix6d J =
      moment_arm_jacobian(edge.T_from_to.translation() - a_b.T_from_to.translation());
  edge.information =
      information_of(J * covariance_of(a_b.information) * J.transpose() +
                     rotated(covariance_of(b_c.information), a_b.T_from_to.linear()));
  return edge;
}

PoseEdge3d reversed(const PoseEdge3d& edge) {
  PoseEdge3d back{.from = edge.to,
                  .to = edge.from,
                  .T_from_to = edge.T_from_to.inverse(),
                  .may_be_wrong = edge.may_be_wrong};
  // A motion of `from`, as `to` sees it.
  const Matrix6d J = moment_arm_jacobian(-edge.T_from_to.translation());
  back.information = rotated(information_of(J * covariance_of(edge.information) * J.transpose()),
                             edge.T_from_to.linear().transpose());
  return back;
}

}  // namespace nodmap::slam6d
