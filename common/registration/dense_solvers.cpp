// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/dense_solvers.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace nodmap::registration {

Matrix6d inverse(const Matrix6d& matrix) {
  return matrix.inverse();
}

template <int N>
Eigen::Matrix<double, N, N> inverse_definite(const Eigen::Matrix<double, N, N>& matrix) {
  return matrix.llt().solve(Eigen::Matrix<double, N, N>::Identity());
}

template Matrix6d inverse_definite(const Matrix6d&);
template Eigen::Matrix<double, 12, 12> inverse_definite(const Eigen::Matrix<double, 12, 12>&);

Matrix6d solve(const Matrix6d& A, const Matrix6d& B) {
  return A.partialPivLu().solve(B);
}

Eigensystem eigensystem(const Matrix6d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Vector6d relative_eigenvalues(const Matrix6d& A, const Matrix6d& B) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d>(A, B,
                                                            Eigen::EigenvaluesOnly | Eigen::Ax_lBx)
      .eigenvalues();
}

}  // namespace nodmap::registration
