// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace nodmap::formats {

/// What an OctoMap file (.bt) says is occupied: the leaves of its tree.
struct OccupiedSpace {
  /// Levels of an octree below its root, and the key of the voxel whose lower corner is the origin.
  static constexpr unsigned kLevels = 16;
  static constexpr std::int32_t kOriginKey = 1 << (kLevels - 1);

  /// A cube of 2^level voxels along each edge.
  struct Cube {
    std::array<std::uint16_t, 3> key{};  ///< of its lower corner, x y z
    std::uint8_t level = 0;
  };

  double voxel_m = 0.0;
  std::vector<Cube> cubes;
};

/// Reads the bytes of a .bt file, which may be anything: empty where they are none. Takes 32 bytes
/// of memory for each byte of the file at most.
/// Source: https://octomap.github.io, OcTreeBase writeBinary(): a text head, then the inner nodes
/// from the root on, two bits for each child.
[[nodiscard]] std::optional<OccupiedSpace> read_octomap(std::string_view bytes);

}  // namespace nodmap::formats
