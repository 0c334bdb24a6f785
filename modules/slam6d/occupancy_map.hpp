// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// A 3D occupancy map in an octree (OctoMap: Hornung et al. 2013). The clouds stay outside: a map
/// from corrected poses is a new one into which they are inserted again.
class OccupancyMap {
 public:
  struct Options {
    double resolution_m = 0.05;  ///< edge of a voxel
    double max_range_m = 10.0;  ///< beams enter up to this length; longer ones are free up to there
    /// Of the beams into one voxel only the first is traced, and to its middle: what OctoMap calls
    /// discretizing. Faster for dense clouds, and less exact.
    bool discretize = false;
  };

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

  /// Every voxel is touched once for a cloud: occupied where a beam ends in it, else free where one
  /// goes through, each beam from where the mirror was when it was measured. Beams that leave the
  /// octree (65536 voxels wide) are left out. The tree is the one that OctoMap's insertPointCloud()
  /// makes, bit by bit.
  void insert(const SweepCloud& cloud, const geometry::SE3& T_map_base);

  /// The bytes of a map file; empty when OctoMap cannot write them.
  [[nodiscard]] std::optional<std::string> encode(Format format) const;

  [[nodiscard]] std::size_t num_nodes() const;
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace nodmap::slam6d
