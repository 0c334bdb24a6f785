// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>

#include "common/geometry/se2.hpp"

namespace nodmap::slam2d {

enum class FitStatus : std::uint8_t {
  kOk,
  kTooFewPairs,  ///< fewer than two pairs of positive weight
  kNoExtent,     ///< all points of one side coincide: every rotation fits equally well
};

/// The minimum of Eq. 3 in closed form for n = 2.
///
/// Pairs are given one by one, with their weight w_ij; no pair is kept. Points on one line are no
/// trouble in the plane (they are in space): two different points fix the transform.
class RigidFit {
 public:
  struct Solution {
    FitStatus status = FitStatus::kTooFewPairs;
    geometry::SE2 T_model_data;  ///< R and dt of Eq. 3; identity unless the status is kOk
  };

  /// `reference`: a point near the data, to which the sums are taken; keeps their precision far
  /// from the origin.
  explicit RigidFit(Eigen::Vector2d reference = Eigen::Vector2d::Zero())
      : reference_(std::move(reference)) {}

  /// Pairs that are not finite or whose weight is not positive are left out.
  void add(const Eigen::Vector2d& model, const Eigen::Vector2d& data, double weight = 1.0);

  [[nodiscard]] Solution solve() const;

 private:
  Eigen::Vector2d reference_;
  int pairs_ = 0;
  double weight_ = 0.0;
  Eigen::Vector2d model_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d data_ = Eigen::Vector2d::Zero();
  double model_squared_ = 0.0;
  double data_squared_ = 0.0;
  double dot_ = 0.0;    // sum of w d . m
  double cross_ = 0.0;  // sum of w d x m
};

}  // namespace nodmap::slam2d
