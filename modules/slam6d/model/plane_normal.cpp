// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model/plane_normal.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace nodmap::slam6d {
namespace {

// The smallest, the middle and the largest eigenvalue of a symmetric matrix whose trace is near
// zero: the roots of x^3 - c2 x^2 + c1 x - c0.
Eigen::Vector3f symmetric_eigenvalues(const Eigen::Matrix3f& m) {
  constexpr float kThird = 1.0F / 3.0F;
  const float c0 = m(0, 0) * m(1, 1) * m(2, 2) + 2.0F * m(1, 0) * m(2, 0) * m(2, 1) -
                   m(0, 0) * m(2, 1) * m(2, 1) - m(1, 1) * m(2, 0) * m(2, 0) -
                   m(2, 2) * m(1, 0) * m(1, 0);
  const float c1 = m(0, 0) * m(1, 1) - m(1, 0) * m(1, 0) + m(0, 0) * m(2, 2) - m(2, 0) * m(2, 0) +
                   m(1, 1) * m(2, 2) - m(2, 1) * m(2, 1);
  const float middle = (m(0, 0) + m(1, 1) + m(2, 2)) * kThird;
  const float c2 = m(0, 0) + m(1, 1) + m(2, 2);
  const float third_a = std::max((c2 * middle - c1) * kThird, 0.0F);
  const float half_b = 0.5F * (c0 + middle * (2.0F * middle * middle - c1));
  const float q = std::max(third_a * third_a * third_a - half_b * half_b, 0.0F);
  const float rho = std::sqrt(third_a);
  const float theta = std::atan2(std::sqrt(q), half_b) * kThird;
  const float cosine = std::cos(theta);
  const float sine = std::sqrt(3.0F) * std::sin(theta);
  return {middle - rho * (cosine + sine), middle - rho * (cosine - sine),
          middle + 2.0F * rho * cosine};
}

// The unit vector that a symmetric matrix of rank 2 maps to zero: it is orthogonal to all columns.
// Zero if the rank is less.
Eigen::Vector3f kernel_of(const Eigen::Matrix3f& m) {
  Eigen::Index i = 0;
  m.diagonal().cwiseAbs().maxCoeff(&i);
  const Eigen::Vector3f a = m.col(i).cross(m.col((i + 1) % 3));
  const Eigen::Vector3f b = m.col(i).cross(m.col((i + 2) % 3));
  const float square_a = a.squaredNorm();
  const float square_b = b.squaredNorm();
  if (square_a > square_b) {
    return a / std::sqrt(square_a);
  }
  return square_b > 0.0F ? Eigen::Vector3f(b / std::sqrt(square_b)) : Eigen::Vector3f::Zero();
}

}  // namespace

// The arithmetic is that of Eigen's SelfAdjointEigenSolver::computeDirect(), to the last bit. It
// computes all eigenvectors, which takes most of its time.
std::optional<Eigen::Vector3f> plane_normal(const Eigen::Matrix3f& covariance,
                                            float max_thickness) {
  constexpr float kEpsilon = std::numeric_limits<float>::epsilon();
  const float shift = covariance.trace() / 3.0F;
  Eigen::Matrix3f scaled = covariance;
  scaled.diagonal().array() -= shift;
  const float scale = scaled.cwiseAbs().maxCoeff();
  if (!(scale > 0.0F)) {
    return std::nullopt;
  }
  scaled /= scale;
  const Eigen::Vector3f values = symmetric_eigenvalues(scaled);
  const bool is_thin = values[0] * scale + shift < max_thickness * (values[1] * scale + shift);
  const bool is_same = values[1] - values[0] <= 2.0F * kEpsilon * (values[2] - values[1]);
  if (!is_thin || is_same) {
    return std::nullopt;
  }
  scaled.diagonal().array() -= values[0];
  const Eigen::Vector3f normal = kernel_of(scaled);
  return normal.isZero(0.0F) ? std::nullopt : std::optional(normal);
}

}  // namespace nodmap::slam6d
