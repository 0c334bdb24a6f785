// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/ground/plane.hpp"

#include <Eigen/LU>
#include <cmath>

namespace nodmap::navigator {

std::optional<Plane> PlaneFit::solve() const {
  const Eigen::FullPivLU<Eigen::Matrix3d> lu(A_);
  // For points spread over a square metre the determinant of the sums is about n^3; a strip of
  // 40 cm x 20 cm has 1e-5 of that.
  if (num_points_ < 3 || !(std::abs(lu.determinant()) > 1e-8 * std::pow(num_points_, 3))) {
    return std::nullopt;
  }
  const Eigen::Vector3d x = lu.solve(b_);
  return Plane{origin_, x.head<2>(), x.z()};
}

}  // namespace nodmap::navigator
