// SPDX-License-Identifier: BSD-3-Clause
// Evidence that loses weight the more it is contradicted.
#pragma once

namespace nodmap::registration {

/// The weight of a residual by the kernel of Geman and McClure: 1 at zero, 1/4 at its scale.
/// `relative_sq`: the square of the residual divided by that scale.
template <class Scalar>
[[nodiscard]] Scalar geman_mcclure(Scalar relative_sq) {
  const Scalar root = Scalar(1) / (Scalar(1) + relative_sq);
  return root * root;
}

/// The information of a deviation with standard deviation `sigma`, by a kernel whose scale is
/// `kernel` standard deviations.
[[nodiscard]] inline double robust_information(double deviation, double sigma, double kernel) {
  const double relative = deviation / (kernel * sigma);
  return geman_mcclure(relative * relative) / (sigma * sigma);
}

}  // namespace nodmap::registration
