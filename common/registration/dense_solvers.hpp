// SPDX-License-Identifier: BSD-3-Clause
// Inverses and eigenvalues of small matrices. Each of Eigen's decompositions takes seconds to
// compile for each size, so they are compiled here only.
#pragma once

#include <Eigen/Core>

namespace nodmap::registration {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

[[nodiscard]] Matrix6d inverse(const Matrix6d& matrix);

/// The inverse of a symmetric, positive definite matrix. N: 6 or 12.
template <int N>
[[nodiscard]] Eigen::Matrix<double, N, N> inverse_definite(
    const Eigen::Matrix<double, N, N>& matrix);

/// `A^-1 B`.
[[nodiscard]] Matrix6d solve(const Matrix6d& A, const Matrix6d& B);

struct Eigensystem {
  Vector6d values;   ///< ascending
  Matrix6d vectors;  ///< a column for each value
};
[[nodiscard]] Eigensystem eigensystem(const Matrix6d& symmetric);

/// The eigenvalues of `B^-1 A`, ascending: how large A is relative to B along the directions in
/// which both are diagonal. Both are symmetric, B is positive definite.
[[nodiscard]] Vector6d relative_eigenvalues(const Matrix6d& A, const Matrix6d& B);

}  // namespace nodmap::registration
