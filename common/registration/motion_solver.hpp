// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

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
/// measurement (relative to the prior).
///
/// N: 6 or 12; compiled for these alone, as that takes seconds.
template <int N>
[[nodiscard]] MotionEstimate<N> solve_motion(const Information<N>& measurement,
                                             const Eigen::Matrix<double, N, N>& imitated,
                                             const Information<N>& prior);

}  // namespace nodmap::registration
