// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/rigid_fit.hpp"

#include <cmath>

namespace nodmap::slam2d {
namespace {

// Below this share of the squared size the spread of a side is rounding, no extent.
constexpr double kRoundingShare = 1e-12;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

void RigidFit::add(const Eigen::Vector2d& model, const Eigen::Vector2d& data, double weight) {
  if (!(weight > 0.0) || !model.allFinite() || !data.allFinite()) {
    return;
  }
  const Eigen::Vector2d m = model - reference_;
  const Eigen::Vector2d d = data - reference_;
  ++pairs_;
  weight_ += weight;
  model_ += weight * m;
  data_ += weight * d;
  model_squared_ += weight * m.squaredNorm();
  data_squared_ += weight * d.squaredNorm();
  dot_ += weight * d.dot(m);
  cross_ += weight * cross(d, m);
}

RigidFit::Solution RigidFit::solve() const {
  if (pairs_ < 2) {
    return {FitStatus::kTooFewPairs, {}};
  }
  const Eigen::Vector2d c_model = model_ / weight_;
  const Eigen::Vector2d c_data = data_ / weight_;
  const double model_spread = model_squared_ - weight_ * c_model.squaredNorm();
  const double data_spread = data_squared_ - weight_ * c_data.squaredNorm();
  if (!(model_spread > kRoundingShare * model_squared_) ||
      !(data_spread > kRoundingShare * data_squared_)) {
    return {FitStatus::kNoExtent, {}};
  }
  // The rotation between the centred point sets, then the shift between their centroids.
  const double yaw =
      std::atan2(cross_ - weight_ * cross(c_data, c_model), dot_ - weight_ * c_data.dot(c_model));
  geometry::SE2 fit{0.0, 0.0, yaw};
  const Eigen::Vector2d shift = c_model + reference_ - fit * (c_data + reference_);
  fit.x = shift.x();
  fit.y = shift.y();
  return {FitStatus::kOk, fit};
}

}  // namespace nodmap::slam2d
