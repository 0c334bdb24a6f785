// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "modules/slam6d/occupancy/octree_grid.hpp"

namespace nodmap::slam6d {

/// The voxels that one cloud marks as free or occupied, as bits: a dense grid where there are
/// beams, nothing elsewhere, so that its size does not depend on their range.
///
/// Space is divided into cubes of 32 x 32 x 32 voxels. The bits of a cube are in the order of the
/// voxel codes, so that a word is a node of the octree two levels above the leaves.
class CloudVoxels {
 public:
  static constexpr unsigned kLevels = 5;  ///< of an octree within a cube
  static constexpr unsigned kBitsPerWord = 64;
  static constexpr std::size_t kWords = (std::size_t{1} << 3U * kLevels) / kBitsPerWord;
  using Bits = std::array<std::uint64_t, kWords>;

  struct Cube {
    VoxelCode code = 0;  ///< of its voxels, without the bits within the cube
    Bits free{};
    Bits occupied{};  ///< a voxel may be both
  };

  CloudVoxels();

  void clear();

  void mark_free(VoxelCode voxel) { word_of(cube_of(voxel).free, voxel) |= bit_of(voxel); }

  /// Returns whether the voxel was not occupied before.
  bool mark_occupied(VoxelCode voxel) {
    std::uint64_t& word = word_of(cube_of(voxel).occupied, voxel);
    const bool is_new = (word & bit_of(voxel)) == 0U;
    word |= bit_of(voxel);
    return is_new;
  }

  [[nodiscard]] bool is_free(VoxelCode voxel) const {
    const Cube* cube = find(voxel >> 3U * kLevels);
    return cube != nullptr && (cube->free[voxel / kBitsPerWord % kWords] & bit_of(voxel)) != 0U;
  }
  [[nodiscard]] bool is_occupied(VoxelCode voxel) const {
    const Cube* cube = find(voxel >> 3U * kLevels);
    return cube != nullptr && (cube->occupied[voxel / kBitsPerWord % kWords] & bit_of(voxel)) != 0U;
  }

  /// The cubes in which a voxel was marked, in the order of their first one.
  [[nodiscard]] std::span<const std::unique_ptr<Cube>> cubes() const {
    return std::span(cubes_).first(num_cubes_);
  }

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  // A slot of the table from codes to cubes.
  struct Slot {
    VoxelCode code = kNoCode;
    Cube* cube = nullptr;
  };
  static constexpr VoxelCode kNoCode = ~VoxelCode{0};

  static std::uint64_t bit_of(VoxelCode voxel) { return std::uint64_t{1} << voxel % kBitsPerWord; }
  static std::uint64_t& word_of(Bits& bits, VoxelCode voxel) {
    return bits[voxel / kBitsPerWord % kWords];
  }

  // The lowest bits of a code choose the slot: cubes within 512 voxels along each axis never
  // collide.
  Cube& cube_of(VoxelCode voxel) {
    const VoxelCode code = voxel >> 3U * kLevels;
    const Slot& slot = slots_[code & mask_];
    return slot.code == code ? *slot.cube : find_or_add(code);
  }
  [[nodiscard]] const Cube* find(VoxelCode code) const { return slots_[slot_of(code)].cube; }
  Cube& find_or_add(VoxelCode code);
  [[nodiscard]] std::size_t slot_of(VoxelCode code) const;
  void grow();

  std::vector<Slot> slots_;                   // open addressing, 2^k slots
  std::uint32_t mask_;                        // the lowest k bits
  std::vector<std::unique_ptr<Cube>> cubes_;  // kept for their memory
  std::size_t num_cubes_ = 0;                 // of them in use
};

}  // namespace nodmap::slam6d
