// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "modules/slam6d/sweep/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// Weighted sums over correspondences, for the bend of a sweep: how the rotation within it departs
/// from a steady one.
class BendSums {
 public:
  /// Adds a correspondence. `moment`: derivative of the residual with respect to a rotation vector.
  /// `time`: from -1 to 1 over the sweep. `weight`: inverse variance, in units of solve().
  void add(const Eigen::Vector3f& moment, float residual_m, float time, float weight);

  /// The most probable bend (rad, axes of the moments). `scale`: unit of the weights.
  /// `sigma_rad`: standard deviation of bends.
  [[nodiscard]] Bend solve(double scale, double sigma_rad) const;

 private:
  using Sums = Eigen::Matrix4f;  // of moment and residual
  /// The sums of what was measured between two knots, by the knots on which it depends.
  struct Interval {
    Sums first = Sums::Zero();
    Sums both = Sums::Zero();
    Sums last = Sums::Zero();
  };
  std::array<Interval, kBendKnots - 1> intervals_;
};

}  // namespace nodmap::slam6d
