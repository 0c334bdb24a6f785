// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/cloud_tracer.hpp"
#include "modules/slam6d/cloud_voxels.hpp"
#include "modules/slam6d/keyframe.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// How a sweep at some place agrees with what was seen from the keyframes of a map. Where the map
/// knows nothing, nothing counts.
struct Evidence {
  double seen = 0.0;  ///< surfaces of the sweep that the map has, too; floor and ceiling not
  double contradicted = 0.0;  ///< surfaces of the sweep where the map's beams went through

  /// Part of what the map can tell of that contradicts; 0 where it can tell nothing.
  [[nodiscard]] double contradiction_ratio() const {
    const double all = seen + contradicted;
    return all > 0.0 ? contradicted / all : 0.0;
  }
};

/// The space that a map's keyframes have seen: where their beams went through, and where they
/// ended. Registration asks whether surfaces lie on surfaces, which they do in every corridor that
/// looks alike; this asks whether they stand where there is nothing.
class SeenSpace {
 public:
  explicit SeenSpace(std::span<const Keyframe> keyframes);

  enum class Content {
    kUnknown,  ///< all else
    kFree,     ///< beams went through here and through all 26 voxels beside, and ended in none
    kOccupied  ///< a beam ended here or in a voxel beside
  };
  [[nodiscard]] Content at(const Eigen::Vector3f& p_map) const;

  [[nodiscard]] Evidence compare(const VoxelMap& sweep_base, const geometry::SE3& T_map_base) const;

 private:
  CloudTracer tracer_;
  CloudVoxels voxels_;
};

}  // namespace nodmap::slam6d
