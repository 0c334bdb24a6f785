// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/occupancy_metrics.hpp"

#include <algorithm>
#include <cmath>

#include "tools/evaluate/world_surfaces.hpp"

namespace nodmap::trial {
namespace {

using Voxel = ObservedVoxels::Voxel;

std::set<Voxel> occupied_voxels(const formats::OccupiedSpace& map) {
  std::set<Voxel> voxels;
  for (const formats::OccupiedSpace::Cube& cube : map.cubes) {
    const std::int32_t edge = 1 << cube.level;
    Voxel corner{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      corner.at(axis) = cube.key.at(axis) - formats::OccupiedSpace::kOriginKey;
    }
    for (std::int32_t i = 0; i < edge * edge * edge; ++i) {
      voxels.insert(
          {corner[0] + i % edge, corner[1] + i / edge % edge, corner[2] + i / (edge * edge)});
    }
  }
  return voxels;
}

bool has_neighbour(const std::set<Voxel>& voxels, const Voxel& voxel) {
  for (std::int32_t i = 0; i < 27; ++i) {
    if (voxels.contains({voxel[0] + i % 3 - 1, voxel[1] + i / 3 % 3 - 1, voxel[2] + i / 9 - 1})) {
      return true;
    }
  }
  return false;
}

Eigen::Vector3d centre_of(const Voxel& voxel, double voxel_m) {
  return voxel_m * (Eigen::Vector3d(voxel[0], voxel[1], voxel[2]) + Eigen::Vector3d::Constant(0.5));
}

}  // namespace

ObservedVoxels::Voxel ObservedVoxels::voxel_at(const Eigen::Vector3d& p_map) const {
  const Eigen::Vector3i voxel = (p_map / voxel_m()).array().floor().cast<std::int32_t>();
  return {voxel.x(), voxel.y(), voxel.z()};
}

void ObservedVoxels::add(const scan::Scan& scan, const geometry::SE3& T_map_first,
                         const geometry::SE3& T_map_last) {
  for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    const auto range_m = static_cast<double>(scan.ranges_m[beam]);
    if (!scan.is_hit(beam) || range_m > params_.max_range_m) {
      continue;
    }
    const geometry::SE3 T_map_base =
        geometry::interpolate(T_map_first, T_map_last, scan.fraction(beam));
    voxels_.insert(voxel_at(T_map_base * scan::point_in_base(scan, beam, range_m)));
  }
}

OccupancyMetrics occupancy_metrics(const formats::OccupiedSpace& map,
                                   const ObservedVoxels& observed, const geometry::SE3& T_world_map,
                                   const sim::World& world) {
  OccupancyMetrics metrics;
  const std::set<Voxel> occupied = occupied_voxels(map);
  metrics.num_occupied = occupied.size();
  metrics.num_observed = observed.voxels().size();
  if (occupied.empty() || observed.voxels().empty()) {
    return metrics;
  }
  const double voxel_m = observed.voxel_m();
  const evaluate::WorldSurfaces surfaces(world);
  const auto at_surface = std::ranges::count_if(occupied, [&](const Voxel& voxel) {
    return surfaces.distance_m(T_world_map * centre_of(voxel, voxel_m)) <= voxel_m;
  });
  const auto found = std::ranges::count_if(
      observed.voxels(), [&](const Voxel& voxel) { return has_neighbour(occupied, voxel); });
  metrics.precision = static_cast<double>(at_surface) / static_cast<double>(occupied.size());
  metrics.recall = static_cast<double>(found) / static_cast<double>(observed.voxels().size());
  return metrics;
}

}  // namespace nodmap::trial
