// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace nodmap::formats {

/// The occupied leaves of the tree in an OctoMap file (.bt).
struct OccupiedSpace {
  /// Number of levels below the root; key of the voxel whose lower corner is the origin.
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

/// Parses the bytes of a .bt file; empty if they are not valid. Needs at most 32 bytes of memory
/// for each byte of the file. Source: https://octomap.github.io, OcTreeBase writeBinary(): a text
/// head, then the inner nodes from the root on, two bits for each child.
[[nodiscard]] std::optional<OccupiedSpace> read_octomap(std::string_view bytes);

}  // namespace nodmap::formats
