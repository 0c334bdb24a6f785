// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/back_end/keyframe.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/occupancy/cloud_tracer.hpp"
#include "modules/slam6d/occupancy/cloud_voxels.hpp"

namespace nodmap::slam6d {

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

/// How surfaces agree with the space that was seen. Those in unknown space are not counted.
struct Evidence {
  double seen = 0.0;          ///< surfaces in occupied space, without floor and ceiling
  double contradicted = 0.0;  ///< surfaces where beams went through

  /// Fraction of the counted surfaces that contradict; 0 if none is counted.
  [[nodiscard]] double contradiction_ratio() const {
    const double all = seen + contradicted;
    return all > 0.0 ? contradicted / all : 0.0;
  }
};

/// The space that sweeps have seen: where their beams passed through, and where they ended.
/// Registration only checks that surfaces lie on surfaces, which they also do in another corridor
/// that looks alike. This class checks whether they lie in free space: those of a sweep where the
/// map's beams went through, and those of the map where the robot's beams now go through.
class SeenSpace {
 public:
  /// Nothing has been seen.
  explicit SeenSpace(const SeenSpaceParams& params);
  /// What the keyframes of a map saw.
  SeenSpace(const SeenSpaceParams& params, std::span<const Keyframe> keyframes);

  void add(const SweepCloud& cloud, const geometry::SE3& T_map_base) {
    tracer_.trace(cloud, T_map_base, voxels_);
  }

  enum class Content : std::uint8_t {
    kUnknown,  ///< anything else
    kFree,     ///< beams went through here and through all 26 voxels beside, and ended in none
    kOccupied  ///< a beam ended here or in a voxel beside
  };
  [[nodiscard]] Content at(const Eigen::Vector3f& p_map) const;

  /// The surfaces of a sweep.
  [[nodiscard]] Evidence compare(const VoxelMap& sweep_base, const geometry::SE3& T_map_base) const;
  /// The surfaces of a map around the robot, where this is what the robot has seen. `seen_by_map`:
  /// what the map's keyframes saw. Surfaces that their beams went through, too, do not contradict:
  /// these are thin, or have moved.
  [[nodiscard]] Evidence compare_map(const VoxelMap& map, const SeenSpace& seen_by_map,
                                     const Eigen::Vector3d& p_map_base) const;

 private:
  /// Whether beams went through here and through all 26 voxels beside, wherever others ended.
  [[nodiscard]] bool is_passed(const Eigen::Vector3f& p_map) const;

  float sq_max_range_m2_;
  CloudTracer tracer_;
  CloudVoxels voxels_;
};

}  // namespace nodmap::slam6d
