// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plane_residual.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "common/statistics/quantile.hpp"

namespace nodmap::bench {
namespace {

constexpr double kVoxelM = 0.1;
constexpr double kMinRangeM = 0.48;
constexpr double kMaxRangeM = 30.0;
constexpr std::size_t kNeighbours = 16;
constexpr double kNeighboursWithinM = 0.6;
constexpr double kFlat = 0.02;
constexpr double kNearestWithinM = 0.5;

// The normal of the plane at a point of the model, if it has one. All points are looked at: scans
// have some thousand.
std::optional<Eigen::Vector3d> normal_at(const Eigen::Vector3d& p,
                                         std::span<const Eigen::Vector3d> model) {
  std::vector<Eigen::Vector3d> near;
  std::ranges::copy_if(model, std::back_inserter(near), [&p](const Eigen::Vector3d& other) {
    return (other - p).squaredNorm() < kNeighboursWithinM * kNeighboursWithinM;
  });
  if (near.size() < kNeighbours) {
    return std::nullopt;
  }
  std::ranges::nth_element(
      near, near.begin() + kNeighbours - 1, {},
      [&p](const Eigen::Vector3d& other) { return (other - p).squaredNorm(); });
  near.resize(kNeighbours);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& other : near) {
    mean += other / static_cast<double>(kNeighbours);
  }
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& other : near) {
    scatter += (other - mean) * (other - mean).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter);
  if (!(eigen.eigenvalues()[0] < kFlat * eigen.eigenvalues()[1])) {
    return std::nullopt;
  }
  return eigen.eigenvectors().col(0);
}

}  // namespace

std::vector<Eigen::Vector3d> voxel_means(std::span<const Eigen::Vector3d> points) {
  std::map<std::array<long, 3>, std::pair<Eigen::Vector3d, double>> voxels;  // sum and number
  for (const Eigen::Vector3d& p : points) {
    if (p.norm() < kMinRangeM || p.norm() > kMaxRangeM) {
      continue;
    }
    const auto cell = [](double m) { return std::lround(std::floor(m / kVoxelM)); };
    auto& [sum, count] =
        voxels.try_emplace({cell(p.x()), cell(p.y()), cell(p.z())}, Eigen::Vector3d::Zero(), 0.0)
            .first->second;
    sum += p;
    count += 1.0;
  }
  std::vector<Eigen::Vector3d> means;
  means.reserve(voxels.size());
  for (const auto& [cell, voxel] : voxels) {
    means.push_back(voxel.first / voxel.second);
  }
  return means;
}

PlaneResidual plane_residual(std::span<const Eigen::Vector3d> model,
                             std::span<const Eigen::Vector3d> scan,
                             const geometry::SE3& T_model_scan) {
  std::vector<std::optional<Eigen::Vector3d>> normals;
  normals.reserve(model.size());
  for (const Eigen::Vector3d& p : model) {
    normals.push_back(normal_at(p, model));
  }
  std::vector<double> distances;
  for (const Eigen::Vector3d& p_scan : scan) {
    const Eigen::Vector3d p = T_model_scan * p_scan;
    const auto nearest = std::ranges::min_element(
        model, {}, [&p](const Eigen::Vector3d& other) { return (other - p).squaredNorm(); });
    if (nearest == model.end() || (*nearest - p).norm() >= kNearestWithinM) {
      continue;
    }
    if (const auto& normal = normals[static_cast<std::size_t>(nearest - model.begin())]) {
      distances.push_back(std::abs(normal->dot(p - *nearest)));
    }
  }
  const auto share = static_cast<double>(distances.size()) / static_cast<double>(scan.size());
  return {distances.size(), scan.empty() ? 0.0 : share, statistics::quantile(distances, 0.5),
          statistics::quantile(distances, 0.9)};
}

}  // namespace nodmap::bench
