// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/occupancy/beam.hpp"
#include "modules/slam6d/occupancy/cloud_voxels.hpp"
#include "modules/slam6d/occupancy/octree_grid.hpp"
#include "modules/slam6d/occupancy/walked_beams.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// How clouds are converted to voxels.
struct TraceParams {
  double resolution_m = 0.05;
  double max_range_m = 10.0;  ///< beams longer than this are cut off, and free up to there
  bool discretize = false;    ///< as OctoMap's computeDiscreteUpdate()
  /// Of the beams between the same two voxels walk only one, which passes through nearly the same
  /// voxels as the others. No parameter: OctoMap walks all.
  bool walk_once = false;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("resolution_m", resolution_m, {0.01, 1.0}, "Edge of an OctoMap voxel.");
    v.number("max_range_m", max_range_m, {0.5, 100.0},
             "Beams are entered into the OctoMap up to this length.");
    v.flag("discretize", discretize,
           "Enter only the first beam of a sweep into each voxel, and to its middle: faster for "
           "dense clouds, and less exact.");
  }
};

/// Marks the voxels that the beams of a cloud pass through as free, and those in which they end as
/// occupied. Each beam starts where the sensor was when it was measured. The end of a beam is not
/// occupied if the beam is cut off at the maximum range, or if it met something that has moved
/// since. Beams that end outside of the octree (65536 voxels wide) are left out, and counted.
class CloudTracer {
 public:
  explicit CloudTracer(const TraceParams& params);

  /// `is_moved`: of the cloud's points; none: nothing has moved.
  void trace(const SweepCloud& cloud, const geometry::SE3& T_map_base, CloudVoxels& voxels,
             const std::vector<bool>& is_moved = {});

  /// Marks the free voxels on beams that met nothing.
  void trace_free(const SweepCloud& cloud, const geometry::SE3& T_map_base, CloudVoxels& voxels);

  [[nodiscard]] const OctreeGrid& grid() const { return grid_; }
  [[nodiscard]] std::size_t beams_outside() const { return beams_outside_; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  void add_first_beam_into_voxel(const Eigen::Vector3f& p_map, CloudVoxels& voxels);
  void add_beam(const Eigen::Vector3f& p_map, bool is_moved, CloudVoxels& voxels);
  bool begin_line(const SweepCloud::Line& line, const geometry::SE3& T_map_base);
  void walk_beams(CloudVoxels& voxels);

  TraceParams params_;
  OctreeGrid grid_;
  CloudVoxels ends_;                                        // of the beams of this cloud
  WalkedBeams walked_;                                      // the same, if they are walked once
  std::vector<Beam> beams_;                                 // not yet walked
  Eigen::Vector3f p_map_origin_ = Eigen::Vector3f::Zero();  // of the sensor, for these beams
  std::optional<VoxelKey> origin_;
  VoxelCode origin_voxel_ = 0;  // the same
  std::size_t beams_outside_ = 0;
};

}  // namespace nodmap::slam6d
