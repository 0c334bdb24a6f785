// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/point_index.hpp"
#include "modules/slam6d/surface.hpp"

namespace nodmap::slam6d {

/// The incrementally built 3D model, point set M of Eq. 3: the surfaces of all registered sweeps
/// without what they have in common (as the 2D map of IV A: a point that has an equivalent in the
/// model is left out, it brings nothing new).
class Model {
 public:
  struct Partner {
    Eigen::Vector3d p_map;
    Eigen::Vector3d normal_map;  ///< zero where the model is no plane
  };

  /// Points nearer than `point_spacing_m` to a model point are that point.
  explicit Model(double point_spacing_m) : point_spacing_m_(point_spacing_m) {}

  void add(const Surface& surface_base, const geometry::SE3& T_map_base);

  /// The model point nearest to `p_map` and nearer than `max_distance_m`.
  [[nodiscard]] std::optional<Partner> nearest(const Eigen::Vector3d& p_map,
                                               double max_distance_m) const;

  [[nodiscard]] std::span<const Eigen::Vector3d> points() const { return index_.points(); }

 private:
  double point_spacing_m_;
  PointIndex index_;
  std::vector<Eigen::Vector3d> normals_;
};

}  // namespace nodmap::slam6d
