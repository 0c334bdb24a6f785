// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace nodmap::slam6d {

/// The place of a voxel in its grid, along x, y and z: from 1 to 2^21 - 2, so that the voxels
/// around it have places, too.
using VoxelPlace = std::array<std::int32_t, 3>;

/// The numbers of voxels by their places. Voxels are numbered in the order in which they are added,
/// so that nothing depends on the hash. The hash table holds blocks of 4 x 4 x 4 voxels: voxels
/// beside each other, which are mostly looked up together, are side by side in memory.
class VoxelIndex {
 public:
  /// The number that stands for no voxel.
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  VoxelIndex();

  [[nodiscard]] std::size_t size() const { return cells_.size(); }

  /// The number of the voxel at `place`; that of a new one is the size() before.
  std::uint32_t find_or_add(const VoxelPlace& place);

  /// Numbers of up to N voxels, those that exist of N places.
  template <std::size_t N>
  class Found {
   public:
    [[nodiscard]] std::span<const std::uint32_t> numbers() const {
      return std::span(numbers_).first(count_);
    }

    /// Without a branch on whether the voxel exists, which cannot be foretold.
    void add(std::uint32_t number_or_none) {
      numbers_[count_] = number_or_none;
      count_ += number_or_none != kNone ? 1 : 0;
    }

   private:
    std::array<std::uint32_t, N> numbers_{};  // those from count_ on mean nothing
    std::size_t count_ = 0;
  };
  using Corners = Found<8>;
  /// The numbers of the voxel at `place` and of the seven that are one step away along one or more
  /// axes, as far as they exist. `steps`: 1 or -1 along each axis.
  [[nodiscard]] Corners corners(const VoxelPlace& place, const VoxelPlace& steps) const;

  /// Calls `use(i, others)` for each voxel, in their order, with half of those that touch it, so
  /// that each two that touch are met once. `others`: their numbers, a span.
  template <class Use>
  void for_each_with_others(const Use& use) const;

  /// Bytes held.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  // The place of a block as one number. A sum of keys is the key of the sum of places.
  using Key = std::uint64_t;
  static constexpr unsigned kKeyBits = 21;   // of each axis
  static constexpr unsigned kCellBits = 2;   // of each axis
  static constexpr std::size_t kCells = 64;  // of a block
  static constexpr std::uint32_t kNoBlock = 0;

  struct Block {
    Key key = 0;
    std::array<std::uint32_t, kCells> voxels{};
  };
  struct Slot {
    Key key = 0;
    std::uint32_t block = kNoBlock;
  };

  // Half of the 26 voxels around each cell of a block, so that each pair is met once: one step
  // along x, or none and then the same of y, or none and then the same of z.
  struct NearCell {
    std::uint8_t block = 0;  // of NearBlocks
    std::uint8_t cell = 0;
  };
  static constexpr std::size_t kHalfAround = 13;
  using NearCells = std::array<std::array<NearCell, kHalfAround>, kCells>;
  // The blocks that these are in: 0 or 1 step along x, -1 to 1 along y and z.
  using NearBlocks = std::array<std::uint32_t, 18>;

  static constexpr Key pack(std::int32_t x, std::int32_t y, std::int32_t z) {
    return (static_cast<Key>(x) << (2 * kKeyBits)) + (static_cast<Key>(y) << kKeyBits) +
           static_cast<Key>(z);
  }
  static constexpr Key block_key(const VoxelPlace& p) {
    return pack(p[0] >> kCellBits, p[1] >> kCellBits, p[2] >> kCellBits);
  }
  // The cell of a voxel at this place along one axis, the others being 0.
  static constexpr std::uint32_t cell_along(std::size_t axis, std::int32_t place) {
    return (static_cast<std::uint32_t>(place) & 3U) << (kCellBits * (2 - axis));
  }
  static constexpr std::uint32_t cell_of(const VoxelPlace& p) {
    return cell_along(0, p[0]) | cell_along(1, p[1]) | cell_along(2, p[2]);
  }
  static constexpr NearCells near_cells();

  static Block empty_block(Key key);
  [[nodiscard]] std::size_t first_slot(Key key) const {
    return (key * 0x9E3779B97F4A7C15ULL) >> shift_;
  }
  [[nodiscard]] std::uint32_t find_block(Key key) const;
  std::uint32_t find_or_add_block(Key key);
  [[nodiscard]] NearBlocks blocks_near(std::uint32_t block) const;
  void enter(std::uint32_t block);
  void rehash(std::size_t num_slots);

  std::vector<Block> blocks_;         // kNoBlock has no voxels and stands for all that are missing
  std::vector<Slot> slots_;           // open addressing, a power of two
  int shift_ = 0;                     // of the hash to a slot
  std::uint32_t last_ = kNoBlock;     // the block of the last voxel that was found or added
  std::vector<std::uint32_t> cells_;  // of each voxel: block * kCells + cell
};

constexpr VoxelIndex::NearCells VoxelIndex::near_cells() {
  constexpr std::int32_t kEdge = 1 << kCellBits;
  NearCells cells{};
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(kCells); ++i) {
    std::size_t n = 0;
    for (std::int32_t step = 14; step < 27; ++step) {  // 13 is no step
      const VoxelPlace at{(i >> (2 * kCellBits)) + step / 9 - 1,
                          (i >> kCellBits) % kEdge + step / 3 % 3 - 1, i % kEdge + step % 3 - 1};
      const auto block =
          (at[0] >> kCellBits) * 9 + ((at[1] >> kCellBits) + 1) * 3 + (at[2] >> kCellBits) + 1;
      cells[static_cast<std::size_t>(i)][n++] = {static_cast<std::uint8_t>(block),
                                                 static_cast<std::uint8_t>(cell_of(at))};
    }
  }
  return cells;
}

template <class Use>
void VoxelIndex::for_each_with_others(const Use& use) const {
  static constexpr NearCells kNearCells = near_cells();
  std::vector<NearBlocks> near(blocks_.size());
  for (std::uint32_t block = kNoBlock + 1; block < blocks_.size(); ++block) {
    near[block] = blocks_near(block);
  }
  for (std::uint32_t i = 0; i < cells_.size(); ++i) {
    const NearBlocks& blocks = near[cells_[i] / kCells];
    Found<kHalfAround> others;
    for (const NearCell& at : kNearCells[cells_[i] % kCells]) {
      others.add(blocks_[blocks[at.block]].voxels[at.cell]);
    }
    use(i, others.numbers());
  }
}

}  // namespace nodmap::slam6d
