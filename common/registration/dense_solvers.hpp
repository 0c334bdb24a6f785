// SPDX-License-Identifier: BSD-3-Clause
// Inverses and eigenvalues of small matrices. Each of Eigen's decompositions takes seconds to
// compile for each size: use these, which are compiled once.
#pragma once

#include <Eigen/Core>

namespace nodmap::registration {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// N: 3 or 6.
template <int N>
[[nodiscard]] Eigen::Matrix<double, N, N> inverse(const Eigen::Matrix<double, N, N>& matrix);

/// The inverse of a symmetric, positive definite matrix. N: 6 or 12.
template <int N>
[[nodiscard]] Eigen::Matrix<double, N, N> inverse_definite(
    const Eigen::Matrix<double, N, N>& matrix);

/// `A^-1 B`.
[[nodiscard]] Matrix6d solve(const Matrix6d& A, const Matrix6d& B);

template <int N>
struct Eigensystem {
  Eigen::Matrix<double, N, 1> values;   ///< ascending
  Eigen::Matrix<double, N, N> vectors;  ///< a column for each value
};
/// Of a symmetric matrix, of which the lower triangle is read. N: 3 or 6.
template <int N>
[[nodiscard]] Eigensystem<N> eigensystem(const Eigen::Matrix<double, N, N>& symmetric);

/// The eigenvalues of `B^-1 A`, ascending: how large A is relative to B along the directions in
/// which both are diagonal. Both are symmetric, B is positive definite.
[[nodiscard]] Vector6d relative_eigenvalues(const Matrix6d& A, const Matrix6d& B);

}  // namespace nodmap::registration
