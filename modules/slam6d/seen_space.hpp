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

/// A surface whose unit normal rises less than this is upright: a wall.
inline constexpr float kMaxUprightNormal = 0.5F;

/// How finely and how far it is remembered where a map's beams went through.
struct SeenSpaceParams {
  double voxel_size_m = 0.1;
  double max_range_m = 8.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("contradiction_voxel_m", voxel_size_m, {0.02, 1.0},
             "A surface contradicts the map from one to two of these beside what was seen: beyond "
             "all errors of registration and deskewing.");
    v.number("contradiction_range_m", max_range_m, {0.5, 100.0},
             "Only nearer than this: beams of neighbouring scans are 1 degree apart, and farther "
             "away there are voxels between them.");
  }
};

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
  SeenSpace(const SeenSpaceParams& params, std::span<const Keyframe> keyframes);

  enum class Content {
    kUnknown,  ///< all else
    kFree,     ///< beams went through here and through all 26 voxels beside, and ended in none
    kOccupied  ///< a beam ended here or in a voxel beside
  };
  [[nodiscard]] Content at(const Eigen::Vector3f& p_map) const;

  [[nodiscard]] Evidence compare(const VoxelMap& sweep_base, const geometry::SE3& T_map_base) const;

 private:
  float sq_max_range_m2_;
  CloudTracer tracer_;
  CloudVoxels voxels_;
};

}  // namespace nodmap::slam6d
