// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/localise/relocaliser.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "common/geometry/whole_steps.hpp"
#include "modules/slam6d/registration/inliers.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

constexpr std::size_t kWallLevel = 1;
// Numbers of wall points that are tried: the most, and the least that determine a place.
constexpr std::size_t kMaxPoints = 300;
constexpr std::size_t kMinPoints = 60;
// The most cells of a size: a building of 200 m x 200 m x 5 m, 25 MB. In a larger one the smallest
// cells are not used.
constexpr double kMaxCells = 2.5e7;
// Number of cell sizes: from two thirds of a position step up to the size for walls 37 m away.
constexpr std::size_t kCellLevels = 4;
constexpr double kCellsPerStep = 1.5;
// Standard deviations of height and tilt relative to those when the map was made.
constexpr double kSigmaHeightM = 0.05;
constexpr double kSigmaTiltRad = geometry::deg_to_rad(2.0);

// The walls of the map. Walls seen from far away have planes only in its coarsest voxels.
std::vector<Eigen::Vector3f> wall_means(const VoxelMap& map) {
  std::vector<Eigen::Vector3f> means;
  for (std::size_t level = kWallLevel; level < VoxelMap::kLevels; ++level) {
    for (const Voxel& voxel : map.level(level).voxels()) {
      if (voxel.has_plane() && is_upright(voxel.normal.z())) {
        means.push_back(voxel.mean);
      }
    }
  }
  return means;
}

// A grid of positions around the keyframes, each once, at the height of a keyframe near it.
std::vector<Eigen::Vector3d> places_about(std::span<const SE3> T_map_keyframes, double reach_m,
                                          double step_m) {
  const int reach = geometry::whole_steps(reach_m, step_m);
  std::set<std::array<int, 3>> taken;
  std::vector<Eigen::Vector3d> places;
  for (const SE3& T_map_base : T_map_keyframes) {
    const Eigen::Vector3d& p = T_map_base.translation();
    const int x = static_cast<int>(std::floor(p.x() / step_m));
    const int y = static_cast<int>(std::floor(p.y() / step_m));
    const int storey = static_cast<int>(std::lround(p.z()));
    for (int dx = -reach; dx <= reach; ++dx) {
      for (int dy = -reach; dy <= reach; ++dy) {
        if (dx * dx + dy * dy <= reach * reach && taken.insert({x + dx, y + dy, storey}).second) {
          places.emplace_back((x + dx + 0.5) * step_m, (y + dy + 0.5) * step_m, p.z());
        }
      }
    }
  }
  return places;
}

}  // namespace

Relocaliser::WallCells::WallCells(const VoxelMap& map, float edge_m) : cell_m(edge_m) {
  Eigen::AlignedBox3f box;
  const std::vector<Eigen::Vector3f> walls = wall_means(map);
  for (const Eigen::Vector3f& mean : walls) {
    box.extend(mean);
  }
  if (box.isEmpty() || (box.sizes() / cell_m).cast<double>().prod() > kMaxCells) {
    return;
  }
  p_first = box.min().array() - 1.5F * cell_m;
  size = (box.sizes() / cell_m).cast<int>().array() + 4;
  near_wall.assign(static_cast<std::size_t>(size.prod()), 0);
  for (const Eigen::Vector3f& mean : walls) {
    const Eigen::Vector3i cell = ((mean - p_first) / cell_m).cast<int>();
    for (int z = cell.z() - 1; z <= cell.z() + 1; ++z) {
      for (int y = cell.y() - 1; y <= cell.y() + 1; ++y) {
        for (int x = cell.x() - 1; x <= cell.x() + 1; ++x) {
          near_wall[index_of({x, y, z})] = 1;
        }
      }
    }
  }
}

bool Relocaliser::WallCells::is_near_wall(const Eigen::Vector3f& p_map) const {
  const Eigen::Array3f at = (p_map - p_first).array() / cell_m;
  if ((at < 0.0F).any() || (at >= size.cast<float>().array()).any()) {
    return false;
  }
  return near_wall[index_of(at.cast<int>())] != 0;
}

std::size_t Relocaliser::WallCells::index_of(const Eigen::Vector3i& cell) const {
  const Eigen::Matrix<std::size_t, 3, 1> at = cell.cast<std::size_t>();
  const Eigen::Matrix<std::size_t, 3, 1> num = size.cast<std::size_t>();
  return (at.z() * num.y() + at.y()) * num.x() + at.x();
}

Relocaliser::Relocaliser(const RelocaliserParams& params, const RegistrationParams& registration,
                         std::span<const SE3> T_map_keyframes, const VoxelMap& map)
    : params_(params),
      registration_(registration),
      places_(places_about(T_map_keyframes, params.reach_m, params.step_m)) {
  for (std::size_t level = 0; level < kCellLevels; ++level) {
    const double edge_m = params_.step_m / kCellsPerStep * std::exp2(level);
    cells_.emplace_back(map, static_cast<float>(edge_m));
  }
}

StartsResult Relocaliser::find(
    const VoxelMap& sweep_base, const VoxelMap& map,
    const std::function<bool(const SE3& T_map_base)>& is_possible) const {
  const std::vector<WallPoint> walls_base = wall_points(sweep_base);
  if (walls_base.size() < kMinPoints) {
    return {};
  }
  VoxelMap sweep = sweep_base;
  sweep.hold();
  return register_from(
      best_starts(try_all(walls_base)), sweep, map,
      [this](const SE3& T_map_start) { return prior_at(T_map_start); }, is_possible, registration_);
}

// Some of the wall points, spread over all of them.
std::vector<Relocaliser::WallPoint> Relocaliser::wall_points(const VoxelMap& sweep_base) const {
  std::vector<Eigen::Vector3f> all;
  for (const OrientedPoint& point : sweep_base.select(kWallLevel).points) {
    if (is_upright(point.normal.z())) {
      all.push_back(point.p);
    }
  }
  std::vector<WallPoint> some;
  for (const Eigen::Vector3f& p : some_of(all, kMaxPoints)) {
    const double off_m = 0.5 * params_.heading_step_rad * static_cast<double>(p.norm());
    std::size_t level = 0;
    while (level + 1 < kCellLevels &&
           (cells_[level].near_wall.empty() || static_cast<double>(cells_[level].cell_m) < off_m)) {
      ++level;
    }
    some.push_back({p, level});
  }
  return some;
}

PosePrior Relocaliser::prior_at(const SE3& T_map_start) const {
  Vector6d sigma;
  sigma << params_.step_m, params_.step_m, kSigmaHeightM, kSigmaTiltRad, kSigmaTiltRad,
      params_.heading_step_rad;
  return {.T_map_base = T_map_start, .covariance = sigma.cwiseAbs2().asDiagonal()};
}

double Relocaliser::part_near_walls(std::span<const WallPoint> walls_rotated,
                                    const Eigen::Vector3f& p_map_base, std::size_t stride) const {
  std::size_t num_checked = 0;
  std::size_t num_near = 0;
  for (std::size_t i = 0; i < walls_rotated.size(); i += stride, ++num_checked) {
    const WallPoint& wall = walls_rotated[i];
    num_near += cells_[wall.level].is_near_wall(wall.p + p_map_base) ? 1 : 0;
  }
  return static_cast<double>(num_near) / static_cast<double>(num_checked);
}

// The poses at which enough points are near a wall. Every fifth point decides whether the others
// are checked.
std::vector<StartPose> Relocaliser::try_all(std::span<const WallPoint> walls_base) const {
  constexpr std::size_t kFirstLook = 5;
  std::vector<StartPose> tried;
  std::vector<WallPoint> rotated(walls_base.begin(), walls_base.end());
  const int num_headings =
      static_cast<int>(std::ceil(2.0 * geometry::kPi / params_.heading_step_rad));
  for (int h = 0; h < num_headings; ++h) {
    SE3 T = SE3::Identity();
    T.linear() = geometry::rotation_of({0.0, 0.0, 2.0 * geometry::kPi * h / num_headings});
    const Eigen::Matrix3f R = T.linear().cast<float>();
    for (std::size_t i = 0; i < rotated.size(); ++i) {
      rotated[i].p = R * walls_base[i].p;
    }
    for (const Eigen::Vector3d& place : places_) {
      const Eigen::Vector3f t = place.cast<float>();
      if (part_near_walls(rotated, t, kFirstLook) < params_.min_inlier_ratio) {
        continue;
      }
      if (const double part = part_near_walls(rotated, t, 1); part >= params_.min_inlier_ratio) {
        T.translation() = place;
        tried.push_back({T, part});
      }
    }
  }
  return tried;
}

}  // namespace nodmap::slam6d
