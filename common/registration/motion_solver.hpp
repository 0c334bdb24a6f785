// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace nodmap::registration {

/// A normal distribution of N unknowns in information form: `H` is the inverse covariance, and the
/// mean is `H^-1 b`.
template <int N>
struct Information {
  Eigen::Matrix<double, N, N> H = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> b = Eigen::Matrix<double, N, 1>::Zero();
};

template <int N>
struct MotionEstimate {
  Eigen::Matrix<double, N, 1> x = Eigen::Matrix<double, N, 1>::Zero();
  Eigen::Matrix<double, N, N> covariance = Eigen::Matrix<double, N, N>::Zero();
  /// Number of directions about which the measurement gives less information than the prior.
  int degenerate_directions = N;
  bool is_valid = false;  ///< false, with zero motion, if the input is not finite or the prior not
                          ///< positive definite
};

/// Computes the most probable motion, given a measurement and a prior, each weighted by its
/// information. The prior, which must be positive definite, therefore determines the directions
/// that the measurement does not constrain, without any threshold.
///
/// `imitated`: the part of the measurement's information that is false, because the measured
/// normals have errors. In a bare corridor, for example, normals that are slightly wrong appear to
/// constrain the position along the corridor. This part is subtracted along each eigenvector of the
/// measurement (relative to the prior). Directions in which less information remains than the prior
/// has are degenerate.
template <int N>
[[nodiscard]] MotionEstimate<N> solve_motion(const Information<N>& measurement,
                                             const Eigen::Matrix<double, N, N>& imitated,
                                             const Information<N>& prior) {
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;
  MotionEstimate<N> estimate;
  const Eigen::LLT<Matrix> llt(prior.H);
  if (!measurement.H.allFinite() || !measurement.b.allFinite() || !imitated.allFinite() ||
      !prior.H.allFinite() || !prior.b.allFinite() || llt.info() != Eigen::Success) {
    return estimate;
  }
  // In units in which the prior is the identity: L^-1 H L^-T with prior.H = L L^T.
  const auto whitened = [&llt](const Matrix& H) -> Matrix {
    const Matrix half = llt.matrixL().solve(H);
    return llt.matrixL().solve(Matrix(half.transpose()));
  };
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(whitened(measurement.H));
  const Matrix& directions = eigen.eigenvectors();
  const Vector imitated_info =
      (directions.transpose() * whitened(imitated) * directions).diagonal();
  const Vector measured_b = directions.transpose() * llt.matrixL().solve(measurement.b);
  const Vector prior_b = directions.transpose() * llt.matrixL().solve(prior.b);
  Vector mean;
  Vector variance;
  estimate.degenerate_directions = 0;
  for (int i = 0; i < N; ++i) {
    const double seeming = std::max(eigen.eigenvalues()[i], 0.0);
    const double information = std::max(seeming - imitated_info[i], 0.0);
    const double kept = seeming > 0.0 ? information / seeming : 0.0;
    variance[i] = 1.0 / (information + 1.0);
    mean[i] = variance[i] * (kept * measured_b[i] + prior_b[i]);
    estimate.degenerate_directions += information < 1.0 ? 1 : 0;
  }
  const Matrix back = llt.matrixU().solve(directions);
  estimate.x = back * mean;
  estimate.covariance = back * variance.asDiagonal() * back.transpose();
  estimate.is_valid = true;
  return estimate;
}

}  // namespace nodmap::registration
