// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/model/voxel_index.hpp"

#include <bit>

namespace nodmap::slam6d {
namespace {

constexpr std::size_t kMinSlots = 256;

}  // namespace

VoxelIndex::VoxelIndex() {
  blocks_.push_back(empty_block(0));
  rehash(kMinSlots);
}

VoxelIndex::Block VoxelIndex::empty_block(Key key) {
  Block block{.key = key};
  block.voxels.fill(kNone);
  return block;
}

std::uint32_t VoxelIndex::find_block(Key key) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = first_slot(key);
  while (slots_[i].block != kNoBlock && slots_[i].key != key) {
    i = (i + 1) & mask;
  }
  return slots_[i].block;
}

std::uint32_t VoxelIndex::find_or_add_block(Key key) {
  if (const std::uint32_t block = find_block(key); block != kNoBlock) {
    return block;
  }
  const auto block = static_cast<std::uint32_t>(blocks_.size());
  blocks_.push_back(empty_block(key));
  if (2 * blocks_.size() > slots_.size()) {
    rehash(2 * slots_.size());
  } else {
    enter(block);
  }
  return block;
}

void VoxelIndex::enter(std::uint32_t block) {
  const std::size_t mask = slots_.size() - 1;
  std::size_t i = first_slot(blocks_[block].key);
  while (slots_[i].block != kNoBlock) {
    i = (i + 1) & mask;
  }
  slots_[i] = {blocks_[block].key, block};
}

void VoxelIndex::rehash(std::size_t num_slots) {
  shift_ = 64 - std::countr_zero(num_slots);
  slots_.assign(num_slots, {});
  for (std::uint32_t block = kNoBlock + 1; block < blocks_.size(); ++block) {
    enter(block);
  }
}

std::uint32_t VoxelIndex::find_or_add(const VoxelPlace& place) {
  const Key key = block_key(place);
  if (last_ == kNoBlock || blocks_[last_].key != key) {
    last_ = find_or_add_block(key);
  }
  const std::uint32_t cell = cell_of(place);
  std::uint32_t& voxel = blocks_[last_].voxels[cell];
  if (voxel == kNone) {
    voxel = static_cast<std::uint32_t>(cells_.size());
    cells_.push_back(last_ * static_cast<std::uint32_t>(kCells) + cell);
  }
  return voxel;
}

VoxelIndex::Corners VoxelIndex::corners(const VoxelPlace& place, const VoxelPlace& steps) const {
  std::array<Key, 3> key_steps{};
  std::array<std::array<std::uint32_t, 2>, 3> cells{};  // by axis, without and with the step
  std::size_t crossed = 0;  // axes along which the step leaves the block
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t next = place[axis] + steps[axis];
    const std::int32_t block_step = (next >> kCellBits) - (place[axis] >> kCellBits);
    cells[axis] = {cell_along(axis, place[axis]), cell_along(axis, next)};
    key_steps[axis] = static_cast<Key>(std::int64_t{block_step}) << (kKeyBits * (2 - axis));
    crossed |= (block_step != 0 ? std::size_t{1} : 0) << axis;
  }
  // Bits 0, 1 and 2 of a corner's number: whether it is a step away along x, y and z.
  const Key key = block_key(place);
  std::array<const Block*, 8> blocks{};
  blocks.fill(&blocks_[find_block(key)]);
  for (std::size_t corner = 1; crossed != 0 && corner < blocks.size(); ++corner) {
    const std::size_t first_there = corner & crossed;  // the first corner in the same block
    blocks[corner] = first_there != corner
                         ? blocks[first_there]
                         : &blocks_[find_block(key + (corner & 1U) * key_steps[0] +
                                               (corner >> 1U & 1U) * key_steps[1] +
                                               (corner >> 2U) * key_steps[2])];
  }
  Corners found;
  for (std::size_t corner = 0; corner < blocks.size(); ++corner) {
    const std::uint32_t cell =
        cells[0][corner & 1U] | cells[1][corner >> 1U & 1U] | cells[2][corner >> 2U];
    found.add(blocks[corner]->voxels[cell]);
  }
  return found;
}

VoxelIndex::NearBlocks VoxelIndex::blocks_near(std::uint32_t block) const {
  NearBlocks blocks{};
  std::size_t n = 0;
  for (std::int32_t x = 0; x <= 1; ++x) {
    for (std::int32_t y = -1; y <= 1; ++y) {
      for (std::int32_t z = -1; z <= 1; ++z) {
        blocks[n++] = find_block(blocks_[block].key + pack(x, y, z));
      }
    }
  }
  return blocks;
}

std::size_t VoxelIndex::memory_bytes() const {
  return blocks_.capacity() * sizeof(Block) + slots_.capacity() * sizeof(Slot) +
         cells_.capacity() * sizeof(std::uint32_t);
}

}  // namespace nodmap::slam6d
