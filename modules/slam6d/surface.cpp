// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/surface.hpp"

#include <Eigen/Eigenvalues>
#include <cstdint>
#include <unordered_map>

#include "modules/slam6d/point_index.hpp"

namespace nodmap::slam6d {
namespace {

// A neighbourhood is a plane when it is this much thinner than its second extent (variances).
constexpr double kMaxThickness = 0.1;

// Indices of 21 bits for each axis: 100 km at a spacing of 5 cm.
std::uint64_t cube_key(const Eigen::Vector3d& p, double spacing_m) {
  constexpr std::uint64_t kMask = (1U << 21U) - 1;
  const auto index = [&](double x) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(x / spacing_m))) & kMask;
  };
  return index(p.x()) << 42U | index(p.y()) << 21U | index(p.z());
}

Eigen::Vector3d plane_normal(const PointIndex& index, const Eigen::Vector3d& p,
                             const SurfaceOptions& options) {
  const auto neighbours = index.nearest_k(p, options.plane_neighbours);
  const double sq_radius = options.plane_radius_m * options.plane_radius_m;
  if (neighbours.size() < options.plane_neighbours ||
      neighbours.back().sq_distance_m2 > sq_radius) {
    return Eigen::Vector3d::Zero();
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& neighbour : neighbours) {
    mean += index.points()[neighbour.index];
  }
  mean /= static_cast<double>(neighbours.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const auto& neighbour : neighbours) {
    const Eigen::Vector3d d = index.points()[neighbour.index] - mean;
    scatter += d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(scatter);
  const Eigen::Vector3d& variances = eigen.eigenvalues();
  return variances[0] < kMaxThickness * variances[1] ? Eigen::Vector3d(eigen.eigenvectors().col(0))
                                                     : Eigen::Vector3d::Zero();
}

}  // namespace

std::vector<Eigen::Vector3d> thin(std::span<const Eigen::Vector3d> points, double spacing_m) {
  std::unordered_map<std::uint64_t, std::size_t> cube_of_key;
  cube_of_key.reserve(points.size() / 4);
  std::vector<Eigen::Vector3d> means;
  std::vector<double> counts;
  for (const Eigen::Vector3d& p : points) {
    if (!p.allFinite()) {
      continue;
    }
    const auto [cube, is_new] = cube_of_key.try_emplace(cube_key(p, spacing_m), means.size());
    if (is_new) {
      means.emplace_back(Eigen::Vector3d::Zero());
      counts.push_back(0.0);
    }
    means[cube->second] += p;
    counts[cube->second] += 1.0;
  }
  for (std::size_t i = 0; i < means.size(); ++i) {
    means[i] /= counts[i];
  }
  return means;
}

Surface extract_surface(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& p_view,
                        const SurfaceOptions& options) {
  Surface surface;
  surface.points = thin(points, options.point_spacing_m);
  PointIndex index;
  index.add(surface.points);
  surface.normals.reserve(surface.points.size());
  for (const Eigen::Vector3d& p : surface.points) {
    const Eigen::Vector3d normal = plane_normal(index, p, options);
    surface.normals.emplace_back(normal.dot(p_view - p) < 0.0 ? Eigen::Vector3d(-normal) : normal);
  }
  return surface;
}

}  // namespace nodmap::slam6d
