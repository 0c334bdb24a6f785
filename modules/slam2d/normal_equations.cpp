// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/normal_equations.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace nodmap::slam2d {

struct NormalEquations::Eigensystem {
  Eigen::Vector3d to_metres;  // x, y, yaw times this are all in metres
  Eigen::Vector3d values;     // increasing
  Eigen::Matrix3d vectors;
};

void NormalEquations::add(const Eigen::Vector2d& normal, const Eigen::Vector2d& lever,
                          double error_m, double weight) {
  const Eigen::Vector3d row(normal.x(), normal.y(),
                            lever.x() * normal.y() - lever.y() * normal.x());
  information_ += weight * row * row.transpose();
  gradient_ += weight * error_m * row;
  weight_ += weight;
}

NormalEquations::Eigensystem NormalEquations::decompose() const {
  constexpr double kMinLever = 0.1;  // metres; keeps the scale finite when nothing tells of yaw
  const double translation = information_(0, 0) + information_(1, 1);
  const double lever =
      translation > 0.0 ? std::max(kMinLever, std::sqrt(information_(2, 2) / translation)) : 1.0;
  const Eigen::Vector3d to_metres(1.0, 1.0, lever);
  const Eigen::Vector3d scale = to_metres.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scale.asDiagonal() * information_ *
                                                              scale.asDiagonal());
  return {to_metres, solver.eigenvalues(), solver.eigenvectors()};
}

NormalEquations::Observability NormalEquations::observability(double weak_share) const {
  const Eigensystem system = decompose();
  Observability result;
  Eigen::Matrix3d kept = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) {
    if (system.values[k] > weak_share * weight_) {
      kept += system.vectors.col(k) * system.vectors.col(k).transpose();
    } else {
      ++result.weak_directions;
    }
  }
  result.observable =
      system.to_metres.cwiseInverse().asDiagonal() * kept * system.to_metres.asDiagonal();
  return result;
}

Eigen::Matrix3d NormalEquations::information(double weak_share) const {
  const Eigen::Matrix3d observable = observability(weak_share).observable;
  return observable.transpose() * information_ * observable;
}

Eigen::Vector3d NormalEquations::step(double weak_share) const {
  const Eigensystem system = decompose();
  const Eigen::Vector3d gradient = system.to_metres.cwiseInverse().cwiseProduct(gradient_);
  Eigen::Vector3d step = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    if (system.values[k] > weak_share * weight_) {
      const auto direction = system.vectors.col(k);
      step -= direction.dot(gradient) / system.values[k] * direction;
    }
  }
  return system.to_metres.cwiseInverse().cwiseProduct(step);
}

}  // namespace nodmap::slam2d
