// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/occupancy/cloud_voxels.hpp"

#include <algorithm>

namespace nodmap::slam6d {
namespace {

constexpr std::size_t kFirstSlots = std::size_t{1} << 12U;  // of 512 voxels along each axis

}  // namespace

CloudVoxels::CloudVoxels() : slots_(kFirstSlots), mask_(kFirstSlots - 1) {}

void CloudVoxels::clear() {
  for (const auto& cube : cubes()) {
    *cube = {};
  }
  num_cubes_ = 0;
  std::ranges::fill(slots_, Slot{});
}

CloudVoxels::Cube& CloudVoxels::find_or_add(VoxelCode code) {
  if (const Slot& slot = slots_[slot_of(code)]; slot.code == code) {
    return *slot.cube;
  }
  if (2 * (num_cubes_ + 1) > slots_.size()) {
    grow();
  }
  if (num_cubes_ == cubes_.size()) {
    cubes_.push_back(std::make_unique<Cube>());
  }
  Cube& cube = *cubes_[num_cubes_++];
  cube.code = code;
  slots_[slot_of(code)] = {code, &cube};
  return cube;
}

// The slot of a cube, or the free slot into which it would go.
std::size_t CloudVoxels::slot_of(VoxelCode code) const {
  std::size_t at = code & mask_;
  while (slots_[at].code != code && slots_[at].code != kNoCode) {
    at = (at + 1) & mask_;
  }
  return at;
}

void CloudVoxels::grow() {
  slots_.assign(2 * slots_.size(), {});
  mask_ = static_cast<std::uint32_t>(slots_.size() - 1);
  for (const auto& cube : cubes()) {
    slots_[slot_of(cube->code)] = {cube->code, cube.get()};
  }
}

std::size_t CloudVoxels::memory_bytes() const {
  return slots_.size() * sizeof(Slot) + cubes_.size() * (sizeof(Cube) + sizeof(cubes_[0]));
}

}  // namespace nodmap::slam6d
