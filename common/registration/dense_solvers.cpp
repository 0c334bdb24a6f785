// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/dense_solvers.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace nodmap::registration {

template <int N>
Eigen::Matrix<double, N, N> inverse(const Eigen::Matrix<double, N, N>& matrix) {
  return matrix.inverse();
}

template Eigen::Matrix3d inverse(const Eigen::Matrix3d&);
template Matrix6d inverse(const Matrix6d&);

template <int N>
Eigen::Matrix<double, N, N> inverse_definite(const Eigen::Matrix<double, N, N>& matrix) {
  return matrix.llt().solve(Eigen::Matrix<double, N, N>::Identity());
}

template Matrix6d inverse_definite(const Matrix6d&);
template Eigen::Matrix<double, 12, 12> inverse_definite(const Eigen::Matrix<double, 12, 12>&);

Matrix6d solve(const Matrix6d& A, const Matrix6d& B) {
  return A.partialPivLu().solve(B);
}

template <int N>
Eigensystem<N> eigensystem(const Eigen::Matrix<double, N, N>& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

template Eigensystem<3> eigensystem(const Eigen::Matrix3d&);
template Eigensystem<6> eigensystem(const Matrix6d&);

Vector6d relative_eigenvalues(const Matrix6d& A, const Matrix6d& B) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d>(A, B,
                                                            Eigen::EigenvaluesOnly | Eigen::Ax_lBx)
      .eigenvalues();
}

}  // namespace nodmap::registration
