// SPDX-License-Identifier: BSD-3-Clause
#include "common/registration/rigid_fit_2d.hpp"

#include <cmath>

namespace nodmap::registration {
namespace {

// A spread below this, relative to the squared coordinates, is rounding error.
constexpr double kRelativeRounding = 1e-12;

}  // namespace

std::optional<geometry::SE2> RigidFit2d::solve() const {
  if (correspondences_ < 2) {
    return std::nullopt;
  }
  const Eigen::Vector2d c_model = model_ / weight_;
  const Eigen::Vector2d c_data = data_ / weight_;
  const double model_spread = model_squared_ - weight_ * c_model.squaredNorm();
  const double data_spread = data_squared_ - weight_ * c_data.squaredNorm();
  if (!(model_spread > kRelativeRounding * model_squared_) ||
      !(data_spread > kRelativeRounding * data_squared_)) {
    return std::nullopt;
  }
  // The rotation between the centred point sets, then the translation between their centroids.
  const double yaw =
      std::atan2(cross_ - weight_ * cross(c_data, c_model), dot_ - weight_ * c_data.dot(c_model));
  geometry::SE2 fit{0.0, 0.0, yaw};
  const Eigen::Vector2d translation = c_model + reference_ - fit * (c_data + reference_);
  fit.x = translation.x();
  fit.y = translation.y();
  return fit;
}

}  // namespace nodmap::registration
