// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/localise/seen_space.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "modules/slam6d/registration/inliers.hpp"

namespace nodmap::slam6d {
namespace {

void count(SeenSpace::Content content, const Eigen::Vector3f& normal, Evidence& evidence) {
  if (content == SeenSpace::Content::kFree) {
    evidence.contradicted += 1.0;
  } else if (content == SeenSpace::Content::kOccupied && is_upright(normal.z())) {
    evidence.seen += 1.0;
  }
}

}  // namespace

SeenSpace::SeenSpace(const SeenSpaceParams& params)
    : sq_max_range_m2_(static_cast<float>(params.max_range_m * params.max_range_m)),
      tracer_({.resolution_m = params.voxel_size_m, .max_range_m = params.max_range_m}) {}

SeenSpace::SeenSpace(const SeenSpaceParams& params, std::span<const Keyframe> keyframes)
    : SeenSpace(params) {
  for (const Keyframe& keyframe : keyframes) {
    add(*keyframe.cloud, keyframe.T_map_base);
  }
}

SeenSpace::Content SeenSpace::at(const Eigen::Vector3f& p_map) const {
  const auto here = tracer_.grid().key_of(p_map);
  if (here && std::ranges::any_of(neighbourhood_of(*here),
                                  [this](VoxelCode code) { return voxels_.is_occupied(code); })) {
    return Content::kOccupied;
  }
  return is_passed(p_map) ? Content::kFree : Content::kUnknown;
}

bool SeenSpace::is_passed(const Eigen::Vector3f& p_map) const {
  const auto here = tracer_.grid().key_of(p_map);
  return here && std::ranges::all_of(neighbourhood_of(*here),
                                     [this](VoxelCode code) { return voxels_.is_free(code); });
}

Evidence SeenSpace::compare(const VoxelMap& sweep_base, const geometry::SE3& T_map_base) const {
  Evidence evidence;
  const Eigen::Isometry3f to_map = T_map_base.cast<float>();
  for (const Voxel& voxel : sweep_base.level(0).voxels()) {
    if (voxel.mean.squaredNorm() <= sq_max_range_m2_) {
      count(at(to_map * voxel.mean), voxel.normal, evidence);
    }
  }
  return evidence;
}

Evidence SeenSpace::compare_map(const VoxelMap& map, const SeenSpace& seen_by_map,
                                const Eigen::Vector3d& p_map_base) const {
  Evidence evidence;
  const Eigen::Vector3f p_robot = p_map_base.cast<float>();
  for (const Voxel& voxel : map.level(0).voxels()) {
    if ((voxel.mean - p_robot).squaredNorm() > sq_max_range_m2_) {
      continue;
    }
    const Content content = at(voxel.mean);
    if (content != Content::kFree || !seen_by_map.is_passed(voxel.mean)) {
      count(content, voxel.normal, evidence);
    }
  }
  return evidence;
}

}  // namespace nodmap::slam6d
