// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration/bend_sums.hpp"

#include <Eigen/Cholesky>

namespace nodmap::slam6d {
namespace {

constexpr int kUnknowns = 3 * kBendKnots;
// Of the bends at neighbouring knots: ground and heading change within about a third of a sweep.
constexpr double kCorrelation = 0.7;

using Matrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;

// The inverse covariance of a process whose correlation decays from knot to knot.
Matrix bend_information(double sigma_rad) {
  constexpr double kSquare = kCorrelation * kCorrelation;
  Matrix H = (1.0 + kSquare) * Matrix::Identity();
  H.topLeftCorner<3, 3>() = H.bottomRightCorner<3, 3>() = Eigen::Matrix3d::Identity();
  for (int i = 3; i < kUnknowns; ++i) {
    H(i, i - 3) = H(i - 3, i) = -kCorrelation;
  }
  return H / (sigma_rad * sigma_rad * (1.0 - kSquare));
}

}  // namespace

void BendSums::add(const Eigen::Vector3f& moment, float residual_m, float time, float weight) {
  const BendKnot knot = knot_at(static_cast<double>(time));
  const auto after = static_cast<float>(knot.fraction);
  const float before = 1.0F - after;
  const Eigen::Vector4f row{moment.x(), moment.y(), moment.z(), residual_m};
  const Sums square = weight * row * row.transpose();
  Interval& interval = intervals_[static_cast<std::size_t>(knot.index)];
  interval.first += before * before * square;
  interval.both += before * after * square;
  interval.last += after * after * square;
}

Bend BendSums::solve(double scale, double sigma_rad) const {
  Matrix H = bend_information(sigma_rad);
  Eigen::Matrix<double, kUnknowns, 1> b = Eigen::Matrix<double, kUnknowns, 1>::Zero();
  const auto add = [&](Eigen::Index i, Eigen::Index j, const Sums& sums) {
    H.block<3, 3>(3 * i, 3 * j) += scale * sums.topLeftCorner<3, 3>().cast<double>();
    b.segment<3>(3 * i) += scale * sums.topRightCorner<3, 1>().cast<double>();
  };
  for (int k = 0; k + 1 < kBendKnots; ++k) {
    const Interval& interval = intervals_[static_cast<std::size_t>(k)];
    add(k, k, interval.first);
    add(k, k + 1, interval.both);
    add(k + 1, k, interval.both);
    add(k + 1, k + 1, interval.last);
  }
  return H.llt().solve(b).reshaped<Eigen::ColMajor>(3, kBendKnots);
}

}  // namespace nodmap::slam6d
