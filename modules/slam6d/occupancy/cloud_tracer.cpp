// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/cloud_tracer.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// Beyond this, where no octree reaches, OctoMap's integers would overflow.
constexpr float kFarthestM = 1e6F;

// Number of beams that are walked together, so that they stay in the processor's cache.
constexpr std::size_t kBeamsAtOnce = 1024;

bool is_near(const Eigen::Vector3f& p) {
  return (p.array().abs() < kFarthestM).all();
}

}  // namespace

CloudTracer::CloudTracer(const TraceParams& params) : params_(params), grid_(params.resolution_m) {
  beams_.reserve(kBeamsAtOnce);
}

void CloudTracer::trace(const SweepCloud& cloud, const SE3& T_map_base, CloudVoxels& voxels,
                        const std::vector<bool>& is_moved) {
  if (params_.discretize) {
    ends_.clear();
  }
  if (params_.walk_once) {
    walked_.clear();
  }
  std::size_t i = 0;
  for (const SweepCloud::Line& line : cloud.lines) {
    if (!begin_line(line, T_map_base)) {
      beams_outside_ += line.end - i;
      i = line.end;
      continue;
    }
    for (; i < line.end; ++i) {
      const Eigen::Vector3f p_map = (T_map_base * cloud.points[i].cast<double>()).cast<float>();
      const bool has_moved = !is_moved.empty() && is_moved[i];
      if (!is_near(p_map)) {
        ++beams_outside_;
      } else if (!params_.discretize || has_moved) {
        add_beam(p_map, has_moved, voxels);
      } else {
        add_first_beam_into_voxel(p_map, voxels);
      }
    }
  }
  walk_beams(voxels);
}

void CloudTracer::trace_free(const SweepCloud& cloud, const SE3& T_map_base, CloudVoxels& voxels) {
  std::size_t i = 0;
  for (const SweepCloud::Line& line : cloud.lines) {
    const bool is_known = begin_line(line, T_map_base);
    for (; i < line.free_end; ++i) {
      const Eigen::Vector3f p_map =
          (T_map_base * cloud.free_points[i].cast<double>()).cast<float>();
      if (is_known && is_near(p_map)) {
        add_beam(p_map, true, voxels);
      }
    }
  }
  walk_beams(voxels);
}

// Where the beams of a line begin; false too far away for an octree.
bool CloudTracer::begin_line(const SweepCloud::Line& line, const SE3& T_map_base) {
  p_map_origin_ = (T_map_base * line.p_base_mirror.cast<double>()).cast<float>();
  if (!is_near(p_map_origin_)) {
    return false;
  }
  origin_ = grid_.key_of(p_map_origin_);
  origin_voxel_ = origin_ ? code_of(*origin_) : 0;
  return true;
}

// As in OctoMap's computeDiscreteUpdate().
void CloudTracer::add_first_beam_into_voxel(const Eigen::Vector3f& p_map, CloudVoxels& voxels) {
  const auto end = grid_.key_of(p_map);
  if (!end) {
    ++beams_outside_;
  } else if (ends_.mark_occupied(code_of(*end))) {
    add_beam(grid_.center_of(*end), false, voxels);
  }
}

// As in OctoMap's computeUpdate().
void CloudTracer::add_beam(const Eigen::Vector3f& p_map, bool is_moved, CloudVoxels& voxels) {
  const Eigen::Vector3f beam = p_map - p_map_origin_;
  const double length_m = length_of(beam);
  const bool ends_inside = length_m <= params_.max_range_m;
  const Eigen::Vector3f p_map_end =
      ends_inside ? p_map
                  : p_map_origin_ + beam / static_cast<float>(length_m) *
                                        static_cast<float>(params_.max_range_m);
  const auto end = grid_.key_of(p_map_end);
  if (!end) {
    ++beams_outside_;
    return;
  }
  const VoxelCode end_voxel = code_of(*end);
  if (ends_inside && !is_moved) {
    voxels.mark_occupied(end_voxel);
  }
  if (!origin_ || origin_voxel_ == end_voxel ||
      (params_.walk_once && !walked_.remember(origin_voxel_, end_voxel))) {
    return;
  }
  beams_.push_back(make_beam(grid_, p_map_origin_, *origin_, p_map_end, *end));
  if (beams_.size() == kBeamsAtOnce) {
    walk_beams(voxels);
  }
}

void CloudTracer::walk_beams(CloudVoxels& voxels) {
  walk(beams_, voxels);
  beams_.clear();
}

std::size_t CloudTracer::memory_bytes() const {
  return ends_.memory_bytes() + walked_.memory_bytes() + beams_.capacity() * sizeof(Beam);
}

}  // namespace nodmap::slam6d
