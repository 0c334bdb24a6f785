// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/normal_equations.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace nodmap::registration {

struct NormalEquations::Eigensystem {
  Eigen::Vector3d to_metres;  // (x, y, yaw) times this is in metres
  Eigen::Vector3d values;     // ascending
  Eigen::Matrix3d vectors;
};

Eigen::Matrix3d NormalEquations::information() const {
  Eigen::Matrix3d information;
  information << sums_.xx, sums_.yx, sums_.yaw_x,  //
      sums_.yx, sums_.yy, sums_.yaw_y,             //
      sums_.yaw_x, sums_.yaw_y, sums_.yaw_yaw;
  return information;
}

NormalEquations::Eigensystem NormalEquations::decompose() const {
  constexpr double kMinMomentArmM =
      0.1;  // keeps the scale finite when there is no information on yaw
  const Eigen::Matrix3d information = this->information();
  const double translation = information(0, 0) + information(1, 1);
  const double moment_arm =
      translation > 0.0 ? std::max(kMinMomentArmM, std::sqrt(information(2, 2) / translation))
                        : 1.0;
  const Eigen::Vector3d to_metres(1.0, 1.0, moment_arm);
  const Eigen::Vector3d scale = to_metres.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scale.asDiagonal() * information *
                                                              scale.asDiagonal());
  return {to_metres, solver.eigenvalues(), solver.eigenvectors()};
}

NormalEquations::Solution NormalEquations::solve(double min_information_ratio) const {
  const Eigensystem system = decompose();
  const Eigen::Vector3d gradient =
      system.to_metres.cwiseInverse().cwiseProduct(Eigen::Vector3d(sums_.x, sums_.y, sums_.yaw));
  Solution solution;
  solution.least_information_ratio = sums_.weight > 0.0 ? system.values[0] / sums_.weight : 0.0;
  Eigen::Matrix3d kept = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const auto direction = system.vectors.col(k);
    if (system.values[k] > min_information_ratio * sums_.weight) {
      kept += direction * direction.transpose();
      solution.step -= direction.dot(gradient) / system.values[k] * direction;
    } else {
      ++solution.degenerate_directions;
    }
  }
  solution.step = system.to_metres.cwiseInverse().cwiseProduct(solution.step);
  solution.projector =
      system.to_metres.cwiseInverse().asDiagonal() * kept * system.to_metres.asDiagonal();
  return solution;
}

Eigen::Matrix3d NormalEquations::information(const Solution& solution) const {
  return solution.projector.transpose() * information() * solution.projector;
}

}  // namespace nodmap::registration
