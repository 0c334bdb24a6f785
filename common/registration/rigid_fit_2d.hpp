// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>

#include "common/geometry/se2.hpp"

namespace nodmap::registration {

/// Solves Eq. 3 for n = 2 in closed form, with real weights w_ij in place of 0 and 1: finds the
/// rotation R and the translation dt with the smallest weighted sum of squared distances
/// ||m_i - (R d_j + dt)||^2 (Umeyama 1991, reduced to sums over the correspondences).
///
/// Correspondences are added one by one and are not stored. In the plane, points on a line
/// determine the transform unless they all coincide; in space they do not determine it.
class RigidFit2d {
 public:
  /// `reference`: a point near the data, metres. Sums are taken relative to it, which keeps their
  /// precision far from the origin; it has no other effect on the solution.
  explicit RigidFit2d(Eigen::Vector2d reference = Eigen::Vector2d::Zero())
      : reference_(std::move(reference)) {}

  /// Adds the correspondence of `data` (d_j) with `model` (m_i), metres. Ignored when a coordinate
  /// is not finite or the weight is not positive.
  void add(const Eigen::Vector2d& model, const Eigen::Vector2d& data, double weight = 1.0) {
    if (!(weight > 0.0) || !model.allFinite() || !data.allFinite()) {
      return;
    }
    const Eigen::Vector2d m = model - reference_;
    const Eigen::Vector2d d = data - reference_;
    ++correspondences_;
    weight_ += weight;
    model_ += weight * m;
    data_ += weight * d;
    model_squared_ += weight * m.squaredNorm();
    data_squared_ += weight * d.squaredNorm();
    dot_ += weight * d.dot(m);
    cross_ += weight * cross(d, m);
  }

  /// R and dt of Eq. 3, T_model_data. Empty with fewer than two correspondences, or if all points
  /// of one side coincide: then every rotation fits equally well.
  [[nodiscard]] std::optional<geometry::SE2> solve() const;

 private:
  [[nodiscard]] static double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
  }

  Eigen::Vector2d reference_;
  int correspondences_ = 0;
  double weight_ = 0.0;
  Eigen::Vector2d model_ = Eigen::Vector2d::Zero();
  Eigen::Vector2d data_ = Eigen::Vector2d::Zero();
  double model_squared_ = 0.0;
  double data_squared_ = 0.0;
  double dot_ = 0.0;    // sum of w d . m
  double cross_ = 0.0;  // sum of w d x m
};

}  // namespace nodmap::registration
