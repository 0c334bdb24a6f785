// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model/voxel_map.hpp"

namespace nodmap::slam6d {
namespace {

// The mean time of each voxel, from the times of its points.
std::vector<float> mean_times(std::span<const std::uint32_t> places, std::span<const float> times,
                              std::size_t num_voxels) {
  std::vector<float> means(num_voxels, 0.0F);
  std::vector<float> counts(num_voxels, 0.0F);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] != VoxelGrid::kNone) {
      means[places[i]] += times[i];
      counts[places[i]] += 1.0F;
    }
  }
  for (std::size_t i = 0; i < num_voxels; ++i) {
    means[i] /= counts[i];
  }
  return means;
}

PointTimes point_times(const SweepCloud& cloud) {
  PointTimes times;
  if (!cloud.is_stationary()) {
    times.half_path = cloud.half_path().cast<float>();
    times.times.reserve(cloud.points.size());
    for (const SweepCloud::Line& line : cloud.lines) {
      times.times.resize(line.end, static_cast<float>(line.time));
    }
  }
  return times;
}

}  // namespace

std::vector<OrientedPoint> oriented_points(const VoxelGrid& grid) {
  std::vector<OrientedPoint> points;
  points.reserve(grid.voxels().size());
  for (const Voxel& voxel : grid.voxels()) {
    points.push_back({voxel.mean, voxel.normal, voxel.weight});
  }
  return points;
}

VoxelMap::VoxelMap(const VoxelMapParams& params)
    : params_(params),
      levels_{VoxelGrid(params.voxel_size_m), VoxelGrid(2.0 * params.voxel_size_m),
              VoxelGrid(4.0 * params.voxel_size_m)} {}

VoxelMap VoxelMap::from_points(std::span<const Eigen::Vector3f> points,
                               const Eigen::Vector3f& p_sensor, const VoxelMapParams& params,
                               const PointTimes& times) {
  VoxelMap map(params);
  map.p_sensor_ = p_sensor;
  map.half_path_ = times.half_path;
  const std::vector<std::uint32_t> places = map.levels_[0].add(points);
  // Each fine voxel counts once, so that the density does not depend on the range.
  for (std::size_t l = 0; l + 1 < kLevels; ++l) {
    const auto fine = map.levels_[l].voxels();
    map.coarser_[l].reserve(fine.size());
    for (const Voxel& voxel : fine) {
      map.coarser_[l].push_back(map.levels_[l + 1].add(voxel.mean, 1.0F));
    }
  }
  for (VoxelGrid& level : map.levels_) {
    level.find_planes(p_sensor, params.plane);
  }
  if (!times.times.empty()) {
    map.times_[0] = mean_times(places, times.times, map.levels_[0].voxels().size());
    for (std::size_t l = 0; l + 1 < kLevels; ++l) {
      map.times_[l + 1] =
          mean_times(map.coarser_[l], map.times_[l], map.levels_[l + 1].voxels().size());
    }
  }
  return map;
}

void VoxelMap::hold() {
  for (std::vector<float>& times : times_) {
    times.clear();
  }
  half_path_.setZero();
}

void VoxelMap::correct(const MotionCorrection& correction) {
  if (!is_moving()) {
    return;
  }
  const Eigen::Vector3d path = half_path_.cast<double>();
  for (std::size_t l = 0; l < kLevels; ++l) {
    levels_[l].move_means([&](std::uint32_t place, const Eigen::Vector3f& mean) {
      const auto time = static_cast<double>(times_[l][place]);
      geometry::SE3 T_base_then = geometry::SE3::Identity();
      T_base_then.translation() = time * path;
      return Eigen::Vector3f((correction.correct(T_base_then, time) *
                              (mean.cast<double>() - T_base_then.translation()))
                                 .cast<float>());
    });
    levels_[l].find_planes(p_sensor_, params_.plane);
  }
  half_path_ += correction.translation_m.cast<float>();
}

void VoxelMap::assign(std::size_t level, std::uint32_t place, std::size_t keyframe) {
  keyframes_[level].resize(levels_[level].voxels().size());
  keyframes_[level][place] = static_cast<std::uint32_t>(keyframe);
}

void VoxelMap::add_sweep(const VoxelMap& sweep_base, const geometry::SE3& T_map_base,
                         std::size_t keyframe) {
  const Eigen::Matrix3f R = T_map_base.linear().cast<float>();
  const Eigen::Vector3f t = T_map_base.translation().cast<float>();
  const auto trusted_sq_m2 = static_cast<float>(params_.trusted_range_m * params_.trusted_range_m);
  for (std::size_t l = 0; l < kLevels; ++l) {
    for (const Voxel& voxel : sweep_base.levels_[l].voxels()) {
      const float sq_range_m2 = (voxel.mean - sweep_base.p_sensor_).squaredNorm();
      const float weight = voxel.weight / (1.0F + sq_range_m2 / trusted_sq_m2);
      const std::uint32_t place = levels_[l].add(R * voxel.mean + t, weight);
      if (place == VoxelGrid::kNone) {
        continue;
      }
      assign(l, place, keyframe);
      if (voxel.has_plane()) {
        levels_[l].add_normal(place, R * voxel.normal, weight);
      }
    }
  }
}

void VoxelMap::add_keyframes(const VoxelMap& map, std::span<const geometry::SE3> T_new_old,
                             const std::vector<bool>& is_chosen) {
  std::vector<Eigen::Isometry3f> motions;
  motions.reserve(T_new_old.size());
  for (const geometry::SE3& motion : T_new_old) {
    motions.push_back(motion.cast<float>());
  }
  for (std::size_t l = 0; l < kLevels; ++l) {
    const auto voxels = map.levels_[l].voxels();
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      const std::uint32_t keyframe = map.keyframes_[l][i];
      if (!is_chosen[keyframe]) {
        continue;
      }
      const Eigen::Isometry3f& motion = motions[keyframe];
      const std::uint32_t place = levels_[l].add(motion * voxels[i].mean, voxels[i].weight);
      if (place == VoxelGrid::kNone) {
        continue;
      }
      assign(l, place, keyframe);
      if (voxels[i].has_plane()) {
        levels_[l].add_normal(place, motion.linear() * voxels[i].normal, voxels[i].normal_weight);
      }
    }
  }
}

void VoxelMap::drop_keyframe(const ReplacedKeyframe& replaced) {
  for (std::vector<std::uint32_t>& keyframes : keyframes_) {
    for (std::uint32_t& keyframe : keyframes) {
      keyframe = static_cast<std::uint32_t>(replaced.renumbered(keyframe));
    }
  }
}

VoxelMap::Selection VoxelMap::select(std::size_t l) const {
  Selection selection;
  selection.points.reserve(levels_[l].voxels().size());
  std::vector<char> is_covered(levels_[l].voxels().size(), 0);
  for (std::size_t level = l; level < kLevels; ++level) {
    selection.first_of_level[level] = selection.points.size();
    add_planes(level, is_covered, selection.points);
    if (level + 1 < kLevels) {
      is_covered = cover_coarser(level, is_covered);
    }
  }
  selection.first_of_level[kLevels] = selection.points.size();
  return selection;
}

void VoxelMap::add_planes(std::size_t level, std::vector<char>& is_covered,
                          std::vector<OrientedPoint>& points) const {
  const auto voxels = levels_[level].voxels();
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    if (is_covered[i] == 0 && voxels[i].has_plane()) {
      is_covered[i] = 1;
      points.push_back({voxels[i].mean, voxels[i].normal, voxels[i].weight,
                        is_moving() ? times_[level][i] : 0.0F});
    }
  }
}

std::vector<char> VoxelMap::cover_coarser(std::size_t level,
                                          const std::vector<char>& is_covered) const {
  std::vector<char> is_coarser_covered(levels_[level + 1].voxels().size(), 0);
  for (std::size_t i = 0; i < is_covered.size(); ++i) {
    if (is_covered[i] != 0 && coarser_[level][i] != VoxelGrid::kNone) {
      is_coarser_covered[coarser_[level][i]] = 1;
    }
  }
  return is_coarser_covered;
}

std::size_t VoxelMap::memory_bytes() const {
  std::size_t bytes = 0;
  for (const VoxelGrid& level : levels_) {
    bytes += level.memory_bytes();
  }
  for (const std::vector<std::uint32_t>& keyframes : keyframes_) {
    bytes += keyframes.capacity() * sizeof(std::uint32_t);
  }
  return bytes;
}

VoxelMap voxelize(const SweepCloud& cloud, const VoxelMapParams& params) {
  return VoxelMap::from_points(cloud.points, cloud.p_base_mirror(), params, point_times(cloud));
}

}  // namespace nodmap::slam6d
