// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace nodmap::registration {

/// A normal distribution of N unknowns in information form: `H` is the inverse covariance, `H^-1 b`
/// the mean.
template <int N>
struct Information {
  Eigen::Matrix<double, N, N> H = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> b = Eigen::Matrix<double, N, 1>::Zero();
};

template <int N>
struct MotionEstimate {
  Eigen::Matrix<double, N, 1> x = Eigen::Matrix<double, N, 1>::Zero();
  Eigen::Matrix<double, N, N> covariance = Eigen::Matrix<double, N, N>::Zero();
  /// How many directions the measurement holds less than the prior does.
  int degenerate_directions = N;
  bool is_valid = false;  ///< false, and nothing moved: not finite, or the prior is not positive
};

/// The motion that is most probable under a measurement and a prior. The prior must be positive
/// definite; it is what holds the directions that the measurement leaves open, softly and without a
/// threshold, in the units of its covariance.
///
/// `imitated` is the information that the errors of the measurement's directions make up where
/// there is none: normals of a bare corridor, each a little wrong, seem to hold it lengthwise.
/// Along each eigenvector of the measurement (relative to the prior) that part is taken off its
/// evidence. Directions about which less is left than the prior knows are called degenerate.
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
