// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/start_poses.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// Finds a sweep in a whole map without knowing anything: near all places from which the map was
/// made, in all headings. The robot is taken to be as upright and as high as it was there.
class PlaceSearch {
 public:
  /// `T_map_keyframes`: from where the map was made.
  PlaceSearch(const RegistrationParams& params, std::span<const geometry::SE3> T_map_keyframes,
              const VoxelMap& map);

  /// Where the sweep lies in that map.
  [[nodiscard]] StartsResult find(const VoxelMap& sweep_base, const VoxelMap& map) const;

 private:
  /// The cells of space within about 30 cm of a wall of the map, one byte each. Only walls tell
  /// place and heading: floor and ceiling fit everywhere.
  struct WallCells {
    explicit WallCells(const VoxelMap& map);
    [[nodiscard]] bool is_near_wall(const Eigen::Vector3f& p_map) const;

    Eigen::Vector3f p_first = Eigen::Vector3f::Zero();  ///< lowest corner
    Eigen::Vector3i size = Eigen::Vector3i::Zero();     ///< cells
    std::vector<std::uint8_t> near_wall;
  };

  [[nodiscard]] std::vector<StartPose> try_all(std::span<const Eigen::Vector3f> walls_base) const;

  RegistrationParams params_;
  WallCells cells_;
  std::vector<Eigen::Vector3d> places_;  ///< positions to be tried
};

}  // namespace nodmap::slam6d
