// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/rigid_fit.hpp"

#include <Eigen/SVD>

namespace nodmap::registration {
namespace {

// Below this ratio of the second to the first singular value the points are on a line as far as
// doubles can tell.
constexpr double kLineRatio = 1e-10;

}  // namespace

// Eigen::umeyama() computes the same, but does not return the singular values, without which points
// on a line cannot be told.
std::optional<geometry::SE3> fit_rigid(std::span<const PointPair> pairs) {
  if (pairs.size() < 3) {
    return std::nullopt;
  }
  // The translation drops out when both sets are relative to their centroids.
  Eigen::Vector3d c_model = Eigen::Vector3d::Zero();
  Eigen::Vector3d c_data = Eigen::Vector3d::Zero();
  for (const PointPair& pair : pairs) {
    c_model += pair.p_model;
    c_data += pair.p_data;
  }
  c_model /= static_cast<double>(pairs.size());
  c_data /= static_cast<double>(pairs.size());

  // E is smallest where trace(R H) is largest: H = U S V^T gives R = V U^T.
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  for (const PointPair& pair : pairs) {
    H += (pair.p_data - c_data) * (pair.p_model - c_model).transpose();
  }
  if (!H.allFinite()) {
    return std::nullopt;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& s = svd.singularValues();
  if (!(s[1] > kLineRatio * s[0])) {
    return std::nullopt;
  }
  // If the points lie in a plane or are noisy, the best orthogonal matrix may be a reflection. The
  // best rotation is then found by flipping the axis of the smallest singular value.
  const Eigen::Matrix3d VU = svd.matrixV() * svd.matrixU().transpose();
  const Eigen::Vector3d no_mirror(1.0, 1.0, VU.determinant() < 0.0 ? -1.0 : 1.0);
  geometry::SE3 T_model_data = geometry::SE3::Identity();
  T_model_data.linear() = svd.matrixV() * no_mirror.asDiagonal() * svd.matrixU().transpose();
  T_model_data.translation() = c_model - T_model_data.linear() * c_data;
  return T_model_data;
}

}  // namespace nodmap::registration
