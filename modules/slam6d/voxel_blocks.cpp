// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/voxel_blocks.hpp"

#include <algorithm>

namespace nodmap::slam6d {
namespace {

constexpr std::size_t kFirstSlots = 8192;
constexpr unsigned kWithin = (1U << VoxelBlocks::kLevels) - 1U;  // the bits of a key in its block
constexpr std::uint64_t kNowhere = ~std::uint64_t{0};

/// Two zeros behind each of the lowest 16 bits.
constexpr std::uint64_t spread_bits(std::uint64_t bits) {
  bits = (bits | bits << 16U) & 0x0000FF0000FFULL;
  bits = (bits | bits << 8U) & 0x00F00F00F00FULL;
  bits = (bits | bits << 4U) & 0x0C30C30C30C3ULL;
  return (bits | bits << 2U) & 0x249249249249ULL;
}

constexpr std::array<std::uint16_t, 8> kSpread = [] {
  std::array<std::uint16_t, 8> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = static_cast<std::uint16_t>(spread_bits(i));
  }
  return table;
}();

/// The Morton code of a voxel within its block: its bit.
unsigned bit_of(const VoxelBlocks::Key& key) {
  return static_cast<unsigned>(kSpread[key[0] & kWithin]) |
         static_cast<unsigned>(kSpread[key[1] & kWithin]) << 1U |
         static_cast<unsigned>(kSpread[key[2] & kWithin]) << 2U;
}

/// Returns whether the bit was not set before.
bool set(VoxelBlocks::Bits& bits, unsigned bit) {
  std::uint64_t& word = bits[bit / 64U];
  const std::uint64_t mask = std::uint64_t{1} << bit % 64U;
  const bool is_new = (word & mask) == 0U;
  word |= mask;
  return is_new;
}

std::uint64_t place_of(const VoxelBlocks::Key& key) {
  constexpr unsigned kShift = VoxelBlocks::kLevels;
  return static_cast<std::uint64_t>(key[0] >> kShift) |
         static_cast<std::uint64_t>(key[1] >> kShift) << 16U |
         static_cast<std::uint64_t>(key[2] >> kShift) << 32U;
}

std::uint64_t code_of_place(std::uint64_t place) {
  return spread_bits(place & 0xFFFFU) | spread_bits(place >> 16U & 0xFFFFU) << 1U |
         spread_bits(place >> 32U) << 2U;
}

std::size_t hash(std::uint64_t place) {
  return static_cast<std::size_t>((place * 0x9E3779B97F4A7C15ULL) >> 32U);
}

}  // namespace

VoxelBlocks::VoxelBlocks() : table_(kFirstSlots, -1), last_place_(kNowhere) {}

void VoxelBlocks::clear() {
  blocks_.clear();
  places_.clear();
  std::ranges::fill(table_, -1);
  last_place_ = kNowhere;
}

void VoxelBlocks::add_free(const Key& key) {
  set(block_at(key).free, bit_of(key));
}

bool VoxelBlocks::add_occupied(const Key& key) {
  return set(block_at(key).occupied, bit_of(key));
}

std::span<const VoxelBlocks::Block> VoxelBlocks::sorted() {
  for (Block& block : blocks_) {
    for (std::size_t word = 0; word < block.free.size(); ++word) {
      block.free[word] &= ~block.occupied[word];
    }
  }
  std::ranges::sort(blocks_, {}, &Block::code);
  return blocks_;
}

VoxelBlocks::Block& VoxelBlocks::block_at(const Key& key) {
  const std::uint64_t place = place_of(key);
  if (place == last_place_) {
    return blocks_[last_block_];
  }
  std::size_t slot = slot_of(place);
  if (table_[slot] < 0) {
    if (2 * (blocks_.size() + 1) > table_.size()) {
      grow_table();
      slot = slot_of(place);
    }
    table_[slot] = static_cast<std::int32_t>(blocks_.size());
    blocks_.push_back({.code = code_of_place(place)});
    places_.push_back(place);
  }
  last_place_ = place;
  last_block_ = static_cast<std::size_t>(table_[slot]);
  return blocks_[last_block_];
}

/// Where the block is in the table, or the free slot where it would go.
std::size_t VoxelBlocks::slot_of(std::uint64_t place) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t slot = hash(place) & mask;
  while (table_[slot] >= 0 && places_[static_cast<std::size_t>(table_[slot])] != place) {
    slot = (slot + 1) & mask;
  }
  return slot;
}

void VoxelBlocks::grow_table() {
  table_.assign(2 * table_.size(), -1);
  for (std::size_t block = 0; block < places_.size(); ++block) {
    table_[slot_of(places_[block])] = static_cast<std::int32_t>(block);
  }
}

}  // namespace nodmap::slam6d
