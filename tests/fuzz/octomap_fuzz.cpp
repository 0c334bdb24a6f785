// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as an OctoMap file: an error, or leaves that are within the tree; and a voxel grid of
// them stays within its limit.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "modules/viewer/foxglove/sensor_views.hpp"

namespace {

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using nodmap::formats::OccupiedSpace;
  const auto space = nodmap::formats::read_octomap({reinterpret_cast<const char*>(data), size});
  if (!space) {
    return 0;
  }
  require(space->cubes.size() <= 4 * size);
  for (const OccupiedSpace::Cube& cube : space->cubes) {
    require(cube.level < OccupiedSpace::kLevels);
    for (const std::uint16_t key : cube.key) {
      require(key % (1U << cube.level) == 0);
    }
  }
  const auto grid = nodmap::foxglove::to_voxel_grid(*space);
  require(grid.columns * grid.rows * grid.slices == static_cast<std::int64_t>(grid.cells.size()));
  require(static_cast<std::int64_t>(grid.cells.size()) <= nodmap::foxglove::VoxelGrid::kMaxCells);
  return 0;
}
