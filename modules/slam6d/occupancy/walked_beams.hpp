// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "modules/slam6d/occupancy/octree_grid.hpp"

namespace nodmap::slam6d {

/// Remembers between which voxels beams were walked: for each hash of an end voxel the last one, so
/// that a beam may be walked again but none is left out.
class WalkedBeams {
 public:
  /// Forgets all.
  void clear() { last_.assign(last_.size(), {}); }

  /// Remembers a beam between two voxels that differ. Returns whether none between them was
  /// remembered.
  bool remember(VoxelCode origin, VoxelCode end) {
    const std::size_t hash = (end * 0x9E3779B97F4A7C15ULL) >> (64U - kHashBits);
    const Ends beam{origin, end};
    return std::exchange(last_[hash], beam) != beam;
  }

  [[nodiscard]] std::size_t memory_bytes() const { return last_.capacity() * sizeof(Ends); }

 private:
  struct Ends {
    VoxelCode origin = 0;
    VoxelCode end = 0;  // the same as the origin: no beam

    bool operator==(const Ends&) const = default;
  };
  // The beams of a sweep end in some thousands of voxels.
  static constexpr unsigned kHashBits = 13;

  std::vector<Ends> last_ = std::vector<Ends>(std::size_t{1} << kHashBits);
};

}  // namespace nodmap::slam6d
