// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace nodmap::slam6d {

/// Points of even density, each with the plane of its neighbourhood.
struct Surface {
  std::vector<Eigen::Vector3d> points;
  /// Unit normal that faces the viewpoint; zero where the neighbourhood is no plane.
  std::vector<Eigen::Vector3d> normals;
};

struct SurfaceOptions {
  double point_spacing_m = 0.1;
  std::size_t plane_neighbours = 16;
  double plane_radius_m = 0.6;
};

/// The mean of the points in each cube of a grid with edges of `spacing_m`: a scanner sees near
/// surfaces a hundred times denser than far ones, a registration is to weigh them alike. In the
/// order in which the cubes were first met; non-finite points are left out.
[[nodiscard]] std::vector<Eigen::Vector3d> thin(std::span<const Eigen::Vector3d> points,
                                                double spacing_m);

/// Thinned points with their planes. `p_view` (same frame) is where they were seen from.
[[nodiscard]] Surface extract_surface(std::span<const Eigen::Vector3d> points,
                                      const Eigen::Vector3d& p_view, const SurfaceOptions& options);

}  // namespace nodmap::slam6d
