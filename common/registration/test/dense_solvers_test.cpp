// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/dense_solvers.hpp"

#include <gtest/gtest.h>

namespace nodmap::registration {
namespace dense_solvers_test {

constexpr double kRounding = 1e-12;  // of well-conditioned matrices

// A lower triangular matrix with ones on its diagonal: no two rows or columns are alike.
template <int N>
Eigen::Matrix<double, N, N> triangle() {
  Eigen::Matrix<double, N, N> L = Eigen::Matrix<double, N, N>::Identity();
  for (int row = 0; row < N; ++row) {
    for (int column = 0; column < row; ++column) {
      L(row, column) = 1.0 / (2.0 + row + 3.0 * column);
    }
  }
  return L;
}

TEST(DenseSolvers, AMatrixTimesItsInverseIsTheIdentity) {
  const Eigen::Matrix3d small = triangle<3>() + 0.5 * triangle<3>().transpose();
  EXPECT_TRUE((small * inverse(small)).isApprox(Eigen::Matrix3d::Identity(), kRounding));
  const Matrix6d A = triangle<6>() + 0.5 * triangle<6>().transpose();
  EXPECT_TRUE((A * inverse(A)).isApprox(Matrix6d::Identity(), kRounding));
  EXPECT_TRUE((A * solve(A, triangle<6>())).isApprox(triangle<6>(), kRounding));
}

TEST(DenseSolvers, ACovarianceTimesItsInverseIsTheIdentity) {
  const Matrix6d pose = triangle<6>() * triangle<6>().transpose();
  EXPECT_TRUE((pose * inverse_definite(pose)).isApprox(Matrix6d::Identity(), kRounding));
  using Matrix12d = Eigen::Matrix<double, 12, 12>;
  const Matrix12d motion = triangle<12>() * triangle<12>().transpose();
  EXPECT_TRUE((motion * inverse_definite(motion)).isApprox(Matrix12d::Identity(), kRounding));
}

template <int N>
void expect_eigensystem_of_a_covariance() {
  using Matrix = Eigen::Matrix<double, N, N>;
  const Matrix A = triangle<N>() * triangle<N>().transpose();
  const auto [values, vectors] = eigensystem(A);
  EXPECT_TRUE((vectors * values.asDiagonal() * vectors.transpose()).isApprox(A, kRounding));
  EXPECT_TRUE((vectors * vectors.transpose()).isApprox(Matrix::Identity(), kRounding));
  for (int i = 1; i < N; ++i) {
    EXPECT_LE(values[i - 1], values[i]);
  }
}

TEST(DenseSolvers, EigenvaluesAscendAndMakeUpTheMatrix) {
  expect_eigensystem_of_a_covariance<3>();
  expect_eigensystem_of_a_covariance<6>();
}

// A = L D L^T relative to B = L L^T has the eigenvalues D.
TEST(DenseSolvers, RelativeEigenvaluesAreThoseAlongCommonDirections) {
  const Vector6d expected{0.1, 0.2, 0.5, 1.0, 2.0, 3.0};
  const Matrix6d L = triangle<6>();
  const Vector6d found =
      relative_eigenvalues(L * expected.asDiagonal() * L.transpose(), L * L.transpose());
  EXPECT_TRUE(found.isApprox(expected, kRounding)) << found.transpose();
}

}  // namespace dense_solvers_test
}  // namespace nodmap::registration
