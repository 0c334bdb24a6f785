// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/seen_space.hpp"

#include <cmath>

namespace nodmap::slam6d {
SeenSpace::SeenSpace(const SeenSpaceParams& params, std::span<const Keyframe> keyframes)
    : sq_max_range_m2_(static_cast<float>(params.max_range_m * params.max_range_m)),
      tracer_({.resolution_m = params.voxel_size_m, .max_range_m = params.max_range_m}) {
  for (const Keyframe& keyframe : keyframes) {
    tracer_.trace(*keyframe.cloud, keyframe.T_map_base, voxels_);
  }
}

SeenSpace::Content SeenSpace::at(const Eigen::Vector3f& p_map) const {
  const auto here = tracer_.grid().key_of(p_map);
  if (!here) {
    return Content::kUnknown;
  }
  bool is_free = true;
  for (int i = 0; i < 27; ++i) {
    const auto beside = [&here](std::size_t axis, int offset) {
      return static_cast<std::uint16_t>((*here)[axis] + offset - 1);
    };
    const VoxelCode voxel = code_of({beside(0, i % 3), beside(1, i / 3 % 3), beside(2, i / 9)});
    if (voxels_.is_occupied(voxel)) {
      return Content::kOccupied;
    }
    is_free = is_free && voxels_.is_free(voxel);
  }
  return is_free ? Content::kFree : Content::kUnknown;
}

Evidence SeenSpace::compare(const VoxelMap& sweep_base, const geometry::SE3& T_map_base) const {
  Evidence evidence;
  const Eigen::Isometry3f to_map = T_map_base.cast<float>();
  for (const Voxel& voxel : sweep_base.level(0).voxels()) {
    if (voxel.mean.squaredNorm() > sq_max_range_m2_) {
      continue;
    }
    const Content content = at(to_map * voxel.mean);
    if (content == Content::kFree) {
      evidence.contradicted += 1.0;
    } else if (content == Content::kOccupied && std::abs(voxel.normal.z()) < kMaxUprightNormal) {
      evidence.seen += 1.0;
    }
  }
  return evidence;
}

}  // namespace nodmap::slam6d
