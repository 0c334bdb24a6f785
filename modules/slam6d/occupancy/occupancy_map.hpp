// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/occupancy/cloud_tracer.hpp"
#include "modules/slam6d/occupancy/cloud_voxels.hpp"
#include "modules/slam6d/occupancy/log_odds_map.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// A 3D occupancy map (OctoMap: Hornung et al. 2013). Its files are bit for bit those of a map made
/// with OctoMap's insertPointCloud(). The octree is built only when a file is requested. The map
/// does not keep the clouds: after poses were corrected, they are inserted into a new map.
class OccupancyMap {
 public:
  enum class Format : std::uint8_t {
    kBt,  ///< occupied or free, compact
    kOt   ///< with probabilities
  };

  explicit OccupancyMap(const TraceParams& params)
      : resolution_m_(params.resolution_m), tracer_(params) {}

  /// Updates each voxel at most once per cloud: as occupied if a beam ends in it, otherwise as free
  /// if a beam passes through it. `is_moved`: for each point, whether it lies on something that
  /// moved; such a point occupies nothing. Empty: no point does.
  void insert(const SweepCloud& cloud, const geometry::SE3& T_map_base,
              const std::vector<bool>& is_moved = {});

  /// The bytes of a map file, or nothing if it cannot be encoded. Visits the whole map.
  [[nodiscard]] std::optional<std::string> encode(Format format) const;

  /// Number of inner nodes and leaves of the octree. Visits the whole map.
  [[nodiscard]] std::size_t num_nodes() const;

  /// Beams that were left out because they end farther from the origin than the octree reaches.
  [[nodiscard]] std::size_t beams_outside() const { return tracer_.beams_outside(); }

  /// Bytes held, including buffers that are reused for the next cloud.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  double resolution_m_;
  CloudTracer tracer_;
  CloudVoxels voxels_;  // of the last cloud; kept to reuse their memory
  LogOddsMap log_odds_;
};

}  // namespace nodmap::slam6d
