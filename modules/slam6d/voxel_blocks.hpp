// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace nodmap::slam6d {

/// Which voxels one cloud says something about, each once, as bits: a dense grid where beams have
/// been, nothing elsewhere, so that its size does not depend on how far they reach.
///
/// Space is cut into cubes of 8 x 8 x 8 voxels. Blocks and the bits within them are in Morton order
/// (the bits of the three axes interleaved, x lowest), the order of an octree's nodes: a block is a
/// node three levels above the leaves, a word one two levels above, a byte a parent of leaves.
class VoxelBlocks {
 public:
  using Key = std::array<std::uint16_t, 3>;  ///< of a voxel: its place on the three axes
  using Bits = std::array<std::uint64_t, 8>;

  static constexpr unsigned kLevels = 3;  ///< of an octree within a block

  struct Block {
    std::uint64_t code = 0;  ///< Morton code of the block's place
    Bits free{};
    Bits occupied{};
  };

  VoxelBlocks();

  void clear();
  void add_free(const Key& key);
  /// Returns whether the voxel was not occupied before.
  bool add_occupied(const Key& key);

  /// The blocks in Morton order. No voxel is both: a hit counts more than any number of beams that
  /// went through (Hornung et al. 2013, section 5.1). Adding goes on after a clear() only.
  [[nodiscard]] std::span<const Block> sorted();

 private:
  [[nodiscard]] Block& block_at(const Key& key);
  [[nodiscard]] std::size_t slot_of(std::uint64_t place) const;
  void grow_table();

  std::vector<Block> blocks_;
  std::vector<std::uint64_t> places_;  // of the blocks, as packed coordinates
  std::vector<std::int32_t> table_;    // open addressing into blocks_, 2^k slots; -1 is free
  std::uint64_t last_place_;           // beams stay in a block for some steps
  std::size_t last_block_ = 0;
};

}  // namespace nodmap::slam6d
