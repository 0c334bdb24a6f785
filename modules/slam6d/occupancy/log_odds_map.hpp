// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>

#include "modules/slam6d/occupancy/cloud_voxels.hpp"
#include "modules/slam6d/occupancy/octree_grid.hpp"

namespace nodmap::slam6d {

/// The log-odds of each voxel being occupied (Hornung et al. 2013, section 3.2), with OctoMap's
/// sensor model and limits. Stored in dense blocks of 8 x 8 x 8 voxels, nothing elsewhere; a block
/// whose voxels are all equal is one number.
class LogOddsMap {
 public:
  static constexpr unsigned kBlockLevels = 3;  ///< of an octree within a block
  static constexpr std::size_t kVoxelsPerBlock = std::size_t{1} << 3U * kBlockLevels;
  static constexpr std::size_t kWordsPerBlock = kVoxelsPerBlock / CloudVoxels::kBitsPerWord;
  static constexpr unsigned kCubeLevels = CloudVoxels::kLevels;  ///< within a cube of blocks
  static constexpr std::size_t kBlocksPerCube = std::size_t{1} << 3U * (kCubeLevels - kBlockLevels);

  /// In the order of the voxel codes.
  struct Voxels {
    std::array<float, kVoxelsPerBlock> log_odds{};
    std::array<std::uint64_t, kWordsPerBlock> known{};  ///< a bit for each voxel
  };
  struct Block {
    bool is_known = false;           ///< at least in part
    float log_odds = 0.0F;           ///< of each voxel, if `voxels` is null
    std::unique_ptr<Voxels> voxels;  ///< null if all are known and equal
  };
  using Cube = std::array<Block, kBlocksPerCube>;  ///< in the order of the voxel codes
  using Cubes = std::map<VoxelCode, Cube>;         ///< by the code of their voxels

  /// Adds a cloud: each marked voxel counts as one hit if it is occupied, otherwise as one miss.
  void update(const CloudVoxels& cloud);

  [[nodiscard]] const Cubes& cubes() const { return cubes_; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  Cubes cubes_;
};

}  // namespace nodmap::slam6d
