// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/log_odds_map.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace nodmap::slam6d {
namespace {

using Voxels = LogOddsMap::Voxels;
using Block = LogOddsMap::Block;
using Words = std::span<const std::uint64_t, LogOddsMap::kWordsPerBlock>;

constexpr std::size_t kVoxelsPerByte = 8;

// OctoMap's sensor model and limits, as it makes them (AbstractOccupancyOcTree.cpp).
float log_odds(double probability) {
  return static_cast<float>(std::log(probability / (1.0 - probability)));
}
const float kHit = log_odds(0.7);
const float kMiss = log_odds(0.4);
const float kLowest = log_odds(0.1192);
const float kHighest = log_odds(0.971);

// For each byte of marks the values of its voxels: the value where the bit is one, otherwise zero.
using ByteTable = std::array<std::array<float, kVoxelsPerByte>, 256>;
ByteTable make_table(float value) {
  ByteTable table{};
  for (std::size_t byte = 0; byte < table.size(); ++byte) {
    for (std::size_t bit = 0; bit < kVoxelsPerByte; ++bit) {
      table[byte][bit] = (byte >> bit & 1U) != 0U ? value : 0.0F;
    }
  }
  return table;
}
const ByteTable kHits = make_table(kHit);
const ByteTable kMisses = make_table(kMiss);

// Updates the voxels of one word; no voxel is both free and occupied.
void update_word(float* values, std::uint64_t free, std::uint64_t occupied) {
  for (; (free | occupied) != 0U; free >>= 8U, occupied >>= 8U, values += kVoxelsPerByte) {
    const auto& miss = kMisses[free & 0xFFU];
    const auto& hit = kHits[occupied & 0xFFU];
    for (std::size_t i = 0; i < kVoxelsPerByte; ++i) {
      values[i] = std::min(std::max(values[i] + (miss[i] + hit[i]), kLowest), kHighest);
    }
  }
}

bool are_all_zero(Words words) {
  std::uint64_t any = 0;
  for (const std::uint64_t word : words) {
    any |= word;
  }
  return any == 0U;
}

bool are_all_alike(const Voxels& voxels) {
  std::uint64_t known = ~std::uint64_t{0};
  for (const std::uint64_t word : voxels.known) {
    known &= word;
  }
  return known == ~std::uint64_t{0} && std::ranges::all_of(voxels.log_odds, [&](float value) {
           return value == voxels.log_odds.front();
         });
}

// Whether a block stays as it is, because all of its voxels are at the limit towards which they
// are marked.
bool is_at_limit(const Block& block, Words free, Words occupied) {
  return block.is_known && !block.voxels &&
         ((block.log_odds <= kLowest && are_all_zero(occupied)) ||
          (block.log_odds >= kHighest && are_all_zero(free)));
}

void open(Block& block) {
  block.voxels = std::make_unique<Voxels>();
  if (block.is_known) {
    block.voxels->log_odds.fill(block.log_odds);
    block.voxels->known.fill(~std::uint64_t{0});
  }
  block.is_known = true;
}

void update_block(Block& block, Words free, Words occupied) {
  if ((are_all_zero(free) && are_all_zero(occupied)) || is_at_limit(block, free, occupied)) {
    return;
  }
  if (!block.voxels) {
    open(block);
  }
  Voxels& voxels = *block.voxels;
  for (std::size_t i = 0; i < LogOddsMap::kWordsPerBlock; ++i) {
    voxels.known[i] |= free[i] | occupied[i];
    // A hit overrides any number of beams of the same cloud that passed through (Hornung et al.,
    // section 5.1).
    update_word(&voxels.log_odds[i * CloudVoxels::kBitsPerWord], free[i] & ~occupied[i],
                occupied[i]);
  }
  if (are_all_alike(voxels)) {
    block.log_odds = voxels.log_odds.front();
    block.voxels.reset();
  }
}

}  // namespace

void LogOddsMap::update(const CloudVoxels& cloud) {
  for (const auto& marked : cloud.cubes()) {
    Cube& cube = cubes_[marked->code];
    for (std::size_t i = 0; i < kBlocksPerCube; ++i) {
      const std::size_t first = i * kWordsPerBlock;
      update_block(cube[i], Words(&marked->free[first], kWordsPerBlock),
                   Words(&marked->occupied[first], kWordsPerBlock));
    }
  }
}

std::size_t LogOddsMap::memory_bytes() const {
  std::size_t blocks = 0;
  for (const auto& [code, cube] : cubes_) {
    blocks += static_cast<std::size_t>(
        std::ranges::count_if(cube, [](const Block& block) { return block.voxels != nullptr; }));
  }
  return cubes_.size() * sizeof(Cubes::value_type) + blocks * sizeof(Voxels);
}

}  // namespace nodmap::slam6d
