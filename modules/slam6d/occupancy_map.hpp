// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/cloud_tracer.hpp"
#include "modules/slam6d/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// A 3D occupancy map (OctoMap: Hornung et al. 2013), bit by bit the one that OctoMap's
/// insertPointCloud() makes. The octree is written when a file is asked for. The clouds stay
/// outside: a map from corrected poses is a new one into which they are inserted again.
class OccupancyMap {
 public:
  using Options = TraceOptions;

  enum class Format {
    kBt,  ///< occupied or free, compact
    kOt   ///< with probabilities
  };

  explicit OccupancyMap(const Options& options);
  ~OccupancyMap();
  OccupancyMap(OccupancyMap&&) noexcept;
  OccupancyMap& operator=(OccupancyMap&&) noexcept;
  OccupancyMap(const OccupancyMap&) = delete;
  OccupancyMap& operator=(const OccupancyMap&) = delete;

  /// Each voxel counts once for a cloud: occupied where a beam ends in it, else free where one goes
  /// through. `is_moved`: points that have moved since, at which nothing is occupied; none: no
  /// point.
  void insert(const SweepCloud& cloud, const geometry::SE3& T_map_base,
              const std::vector<bool>& is_moved = {});

  /// The bytes of a map file. Goes through the whole map.
  [[nodiscard]] std::optional<std::string> encode(Format format) const;

  /// Of the octree, inner nodes and leaves. Goes through the whole map, once after each insertion.
  [[nodiscard]] std::size_t num_nodes() const;
  /// What is kept between two clouds included.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct Map;
  std::unique_ptr<Map> map_;
};

}  // namespace nodmap::slam6d
