// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

namespace nodmap::slam6d {

/// A voxel's place along x, y and z.
using VoxelKey = std::array<std::uint16_t, 3>;

/// A voxel's place as one number, its Morton code: the bits of the three keys interleaved, x
/// lowest. This is the order of an octree's leaves: the code without its lowest 3 n bits names the
/// voxel's ancestor n levels up.
using VoxelCode = std::uint64_t;

inline constexpr unsigned kOctreeLevels = 16;  ///< below the root; a key has a bit for each

/// Two zeros behind each of the lowest 16 bits.
constexpr VoxelCode spread_bits(VoxelCode bits) {
  bits = (bits | bits << 16U) & 0x0000FF0000FFULL;
  bits = (bits | bits << 8U) & 0x00F00F00F00FULL;
  bits = (bits | bits << 4U) & 0x0C30C30C30C3ULL;
  return (bits | bits << 2U) & 0x249249249249ULL;
}

/// The bits of a code that are of x, y and z.
inline constexpr std::array<VoxelCode, 3> kAxisBits{spread_bits(0xFFFF), spread_bits(0xFFFF) << 1U,
                                                    spread_bits(0xFFFF) << 2U};

constexpr VoxelCode code_of(const VoxelKey& key) {
  return spread_bits(key[0]) | spread_bits(key[1]) << 1U | spread_bits(key[2]) << 2U;
}

/// The codes of a voxel and of the 26 beside it, x fastest. Outside of the grid they wrap around.
inline std::array<VoxelCode, 27> neighbourhood_of(const VoxelKey& key) {
  std::array<std::array<VoxelCode, 3>, 3> bits{};  // by axis and step
  for (unsigned axis = 0; axis < 3; ++axis) {
    for (unsigned step = 0; step < 3; ++step) {
      bits[axis][step] = spread_bits(static_cast<std::uint16_t>(key[axis] + step - 1)) << axis;
    }
  }
  std::array<VoxelCode, 27> codes{};
  for (std::size_t i = 0; i < codes.size(); ++i) {
    codes[i] = bits[0][i % 3] | bits[1][i / 3 % 3] | bits[2][i / 9];
  }
  return codes;
}

/// The length as OctoMap computes it: the squares are added in single precision.
inline double length_of(const Eigen::Vector3f& p) {
  return std::sqrt(static_cast<double>(p.x() * p.x() + p.y() * p.y() + p.z() * p.z()));
}

/// OctoMap's division of space into 65536^3 voxels about the origin, in OctoMap's own arithmetic.
/// Coordinates of 1e6 voxels and more would overflow an integer as they do there; callers must
/// exclude them. Source: OctoMap 1.9.7, OcTreeBaseImpl.h, coordToKey() and keyToCoord().
class OctreeGrid {
 public:
  explicit OctreeGrid(double resolution_m)
      : resolution_m_(resolution_m), voxels_per_m_(1.0 / resolution_m) {}

  [[nodiscard]] double resolution_m() const { return resolution_m_; }

  /// How far the grid reaches from the origin, along each axis.
  [[nodiscard]] double reach_m() const { return kOriginKey * resolution_m_; }

  /// The key of the voxel that contains a point; empty outside of the grid.
  [[nodiscard]] std::optional<VoxelKey> key_of(const Eigen::Vector3f& p) const {
    // Filled in place: the processor would wait with a copy until all three parts are stored.
    std::optional<VoxelKey> key(std::in_place);
    for (std::size_t axis = 0; axis < key->size(); ++axis) {
      const float coordinate_m = p[static_cast<Eigen::Index>(axis)];
      // NaN, or more voxels than an integer can hold.
      const bool is_in_reach =
          std::abs(voxels_per_m_ * static_cast<double>(coordinate_m)) <= kOriginKey;
      const int place = is_in_reach ? place_of(coordinate_m) : -1;
      if (place < 0 || place > 0xFFFF) {
        key.reset();
        return key;
      }
      (*key)[axis] = static_cast<std::uint16_t>(place);
    }
    return key;
  }

  [[nodiscard]] double center_m(std::uint16_t key) const {
    return (static_cast<double>(int{key} - kOriginKey) + 0.5) * resolution_m_;
  }

  [[nodiscard]] Eigen::Vector3f center_of(const VoxelKey& key) const {
    return {static_cast<float>(center_m(key[0])), static_cast<float>(center_m(key[1])),
            static_cast<float>(center_m(key[2]))};
  }

 private:
  static constexpr int kOriginKey = 1 << (kOctreeLevels - 1U);

  [[nodiscard]] int place_of(float coordinate_m) const {
    const double place = voxels_per_m_ * static_cast<double>(coordinate_m);
    const int towards_zero = static_cast<int>(place);  // std::floor() would be a call of a function
    return (place < towards_zero ? towards_zero - 1 : towards_zero) + kOriginKey;
  }

  double resolution_m_;
  double voxels_per_m_;
};

}  // namespace nodmap::slam6d
