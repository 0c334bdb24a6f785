// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "modules/viewer/foxglove/sensor_views.hpp"
#include "modules/viewer/foxglove/test/robot_maps.hpp"

namespace nodmap::foxglove {
namespace voxel_grid_test {

VoxelGrid grid_of(double voxel_m, const std::vector<std::array<int, 3>>& voxels) {
  return to_voxel_grid(formats::read_octomap(test::octomap_bytes(voxel_m, voxels)).value());
}

// The cell that contains a point, computed from the sent values; -1 outside.
int at(const VoxelGrid& grid, double x_m, double y_m, double z_m) {
  const Eigen::Vector3d cell = (Eigen::Vector3d(x_m, y_m, z_m) - grid.p_corner) / grid.cell_m;
  const auto column = static_cast<std::int64_t>(std::floor(cell.x()));
  const auto row = static_cast<std::int64_t>(std::floor(cell.y()));
  const auto slice = static_cast<std::int64_t>(std::floor(cell.z()));
  if (column < 0 || row < 0 || slice < 0 || column >= grid.columns || row >= grid.rows ||
      slice >= grid.slices) {
    return -1;
  }
  return grid.cells[static_cast<std::size_t>((slice * grid.rows + row) * grid.columns + column)];
}

TEST(VoxelGrid, EnclosesTheOccupiedVoxelsAndNothingElse) {
  const VoxelGrid grid = grid_of(0.1, {{-3, 2, 0}, {1, 5, 4}});
  EXPECT_EQ(grid.columns, 5);
  EXPECT_EQ(grid.rows, 4);
  EXPECT_EQ(grid.slices, 5);
  EXPECT_NEAR(grid.p_corner.x(), -0.3, 1e-12);
  EXPECT_NEAR(grid.p_corner.y(), 0.2, 1e-12);
  EXPECT_EQ(at(grid, -0.25, 0.25, 0.05), 1);
  EXPECT_EQ(at(grid, 0.15, 0.55, 0.45), 1);
  EXPECT_EQ(std::accumulate(grid.cells.begin(), grid.cells.end(), 0), 2);
}

// Random voxels in a space so large that cells must be coarser: each is in an occupied cell, and
// every occupied cell contains one.
TEST(VoxelGrid, HasLargerCellsForALargeSpace) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> place(-700, 700);
  std::vector<std::array<int, 3>> voxels;
  for (int i = 0; i < 400; ++i) {
    voxels.push_back({place(random), place(random), place(random) / 20});
  }
  const VoxelGrid grid = grid_of(0.05, voxels);
  EXPECT_LE(static_cast<std::int64_t>(grid.cells.size()), VoxelGrid::kMaxCells);
  EXPECT_DOUBLE_EQ(grid.cell_m, 0.4);  // 1401 x 1401 x 71 voxels: / 8^3 is below 2^20, / 4^3 not
  VoxelGrid left = grid;
  for (const auto& v : voxels) {
    const Eigen::Vector3d p = 0.05 * (Eigen::Vector3d(v[0], v[1], v[2]).array() + 0.5).matrix();
    EXPECT_EQ(at(grid, p.x(), p.y(), p.z()), 1);
    const Eigen::Vector3i cell =
        ((p - grid.p_corner) / grid.cell_m).array().floor().cast<int>().matrix();
    left.cells[static_cast<std::size_t>((cell.z() * grid.rows + cell.y()) * grid.columns +
                                        cell.x())] = 0;
  }
  EXPECT_EQ(std::accumulate(left.cells.begin(), left.cells.end(), 0), 0);
}

TEST(VoxelGrid, ALeafOfManyVoxelsOccupiesItsWholeCube) {
  const VoxelGrid grid =
      to_voxel_grid({0.1, {{{32768, 32768, 32768}, 2}, {{32776, 32768, 32768}, 0}}});
  EXPECT_EQ(grid.columns, 9);
  EXPECT_EQ(std::accumulate(grid.cells.begin(), grid.cells.end(), 0), 64 + 1);
}

TEST(VoxelGrid, AFullSpaceIsOneOccupiedCellAndAnEmptyOneIsOneFreeCell) {
  const VoxelGrid all = to_voxel_grid({0.1, {{{0, 0, 0}, 16}, {{65535, 65535, 65535}, 0}}});
  EXPECT_LE(static_cast<std::int64_t>(all.cells.size()), VoxelGrid::kMaxCells);
  EXPECT_EQ(std::accumulate(all.cells.begin(), all.cells.end(), std::size_t{0}), all.cells.size());
  EXPECT_EQ(to_voxel_grid({0.1, {}}).cells, std::vector<std::uint8_t>{0});
}

TEST(VoxelGrid, IsDescribedByItsStrides) {
  const Json json = voxel_grid(time::from_utime(3), grid_of(0.1, {{0, 0, 0}, {4, 2, 1}}));
  EXPECT_EQ(json["column_count"], 5);
  EXPECT_EQ(json["row_count"], 3);
  EXPECT_EQ(json["row_stride"], 5);
  EXPECT_EQ(json["slice_stride"], 15);
  EXPECT_EQ(json["frame_id"], "map_6d");
  EXPECT_EQ(json["fields"][0], Json({{"name", "occupied"}, {"offset", 0}, {"type", 1}}));
  EXPECT_EQ(json["data"].get<std::string>().size(), 40U);  // 30 bytes
}

}  // namespace voxel_grid_test
}  // namespace nodmap::foxglove
