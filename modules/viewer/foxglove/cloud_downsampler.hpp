// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "modules/viewer/foxglove/sensor_views.hpp"

namespace nodmap::foxglove {

/// Downsamples all clouds of a run together: omits a point near one that was kept before, in this
/// or an earlier cloud. So memory grows with the observed surfaces, not with time.
///
/// A point is kept if there is no kept point in its cube or the 26 cubes around it. So kept points
/// are at least `spacing_m` apart, and an omitted point is at most 3.5 times as far from a kept
/// one.
class CloudDownsampler {
 public:
  /// `spacing_m`: 0 keeps every point. `max_points`: how many of the newest kept points are
  /// remembered. A viewer has dropped older ones by then, so points there are kept again.
  CloudDownsampler(double spacing_m, std::size_t max_points);

  /// Removes the points that are near a kept one. A point that is not finite, or more than 2^22
  /// spacings away along an axis, is kept.
  void downsample(CloudView& cloud);

  void clear();

 private:
  /// The indices of a cube along x, y, z, in multiples of the spacing.
  struct Cube {
    std::int32_t x = 0;
    std::int32_t y = 0;
    std::int32_t z = 0;
  };
  /// 8 x 8 x 8 cubes, because surfaces fill a small part of space densely.
  struct Block {
    std::bitset<512> taken;
    std::uint64_t touched = 0;  ///< total number of kept points when the last one was added here
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
