// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "modules/viewer/foxglove/sensor_views.hpp"

namespace nodmap::foxglove {

/// Downsamples the clouds of a run over all of them together: a point is left out where one was
/// kept before, in this cloud or an earlier one. So memory grows with the surfaces seen, not with
/// the time.
///
/// A point is kept if no kept one is in its cube or one of the 26 around it: kept points are at
/// least `spacing_m` apart, and what is left out is at most 3.5 times as far from a kept one.
class CloudDownsampler {
 public:
  /// `spacing_m`: 0 keeps every point. `max_points`: this many of the points kept last are
  /// remembered; a viewer has dropped the others by then, and their places are kept again.
  CloudDownsampler(double spacing_m, std::size_t max_points);

  /// Removes the points that are near a kept one. A point that is not finite, or more than 2^22
  /// spacings away along an axis, is kept.
  void downsample(CloudView& cloud);

  void clear();

 private:
  /// The cube at these places along x, y, z, counted in spacings.
  struct Cube {
    std::int32_t x = 0;
    std::int32_t y = 0;
    std::int32_t z = 0;
  };
  /// 8 x 8 x 8 cubes side by side: surfaces fill a small part of space, and there densely.
  struct Block {
    std::bitset<512> taken;
    std::uint64_t touched = 0;  ///< points kept in all when the last one came in here
  };

  [[nodiscard]] std::optional<Cube> cube_of(const Eigen::Vector3d& p) const;
  [[nodiscard]] bool is_taken(const Cube& cube) const;
  [[nodiscard]] bool is_shown(const Cube& cube) const;
  void take(const Cube& cube);
  [[nodiscard]] bool is_forgotten(const Block& block) const;
  void forget();

  double spacing_m_;
  std::size_t max_points_;
  std::uint64_t kept_ = 0;
  std::uint64_t next_forgetting_;
  std::unordered_map<std::uint64_t, Block> blocks_;
};

}  // namespace nodmap::foxglove
