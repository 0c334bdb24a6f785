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

/// A surface is upright, a wall, if the z component of its unit normal is below this.
inline constexpr float kMaxUprightNormal = 0.5F;

/// Resolution and range of the record of where a map's beams passed.
struct SeenSpaceParams {
  double voxel_size_m = 0.1;
  double max_range_m = 8.0;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number(
        "contradiction_voxel_m", voxel_size_m, {0.02, 1.0},
        "Edge of the voxels of seen space. A surface contradicts the map if it is one to two "
        "voxels inside of free space, which exceeds all errors of registration and deskewing.");
    v.number("contradiction_range_m", max_range_m, {0.5, 100.0},
             "Space counts as seen up to this range. Beams of neighbouring scans are 1 degree "
             "apart; farther away they miss voxels in between.");
  }
};

/// How a sweep at some place agrees with what the keyframes of a map saw. Surfaces where the map
/// knows nothing are not counted.
struct Evidence {
  double seen = 0.0;  ///< surfaces of the sweep that the map has, too, without floor and ceiling
  double contradicted = 0.0;  ///< surfaces of the sweep where the map's beams went through

  /// Fraction of the counted surfaces that contradict; 0 if none is counted.
  [[nodiscard]] double contradiction_ratio() const {
    const double all = seen + contradicted;
    return all > 0.0 ? contradicted / all : 0.0;
  }
};

/// The space that a map's keyframes have seen: where their beams passed through, and where they
/// ended. Registration only checks that surfaces lie on surfaces, which they also do in another
/// corridor that looks alike. This class checks whether they lie in free space.
class SeenSpace {
 public:
  SeenSpace(const SeenSpaceParams& params, std::span<const Keyframe> keyframes);

  enum class Content {
    kUnknown,  ///< anything else
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
