// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/motion_solver.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace nodmap::registration {

template <int N>
MotionEstimate<N> solve_motion(const Information<N>& measurement,
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
  for (int i = 0; i < N; ++i) {
    const double seeming = std::max(eigen.eigenvalues()[i], 0.0);
    const double information = std::max(seeming - imitated_info[i], 0.0);
    const double kept = seeming > 0.0 ? information / seeming : 0.0;
    variance[i] = 1.0 / (information + 1.0);
    mean[i] = variance[i] * (kept * measured_b[i] + prior_b[i]);
  }
  const Matrix back = llt.matrixU().solve(directions);
  estimate.x = back * mean;
  estimate.covariance = back * variance.asDiagonal() * back.transpose();
  estimate.is_valid = true;
  return estimate;
}

template MotionEstimate<6> solve_motion(const Information<6>&, const Eigen::Matrix<double, 6, 6>&,
                                        const Information<6>&);
template MotionEstimate<12> solve_motion(const Information<12>&,
                                         const Eigen::Matrix<double, 12, 12>&,
                                         const Information<12>&);

}  // namespace nodmap::registration
