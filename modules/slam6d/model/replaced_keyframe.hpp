// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"

namespace nodmap::slam6d {

/// A keyframe that is dropped, because newer ones show the same place.
struct ReplacedKeyframe {
  std::size_t index = 0;  ///< before it is dropped
  std::size_t by = 0;     ///< index of the next newer keyframe at its place, before the drop

  /// The index after the drop of what belonged to keyframe `k`: those after the dropped one move
  /// up, and what belonged to the dropped one belongs to the keyframe that replaces it.
  [[nodiscard]] std::size_t renumbered(std::size_t k) const {
    const std::size_t owner = k == index ? by : k;
    return owner - (owner > index ? 1 : 0);
  }
};

/// Whether sweeps at these poses show nearly the same: within 0.75 m and 30 degrees.
[[nodiscard]] bool shows_the_same(const geometry::SE3& a, const geometry::SE3& b);

/// The oldest keyframe at the place of the newest one that has at least `num_newer` newer ones at
/// its place. Elsewhere nothing has changed. Only keyframes in the same map count, because their
/// poses relative to each other are known (`is_in_map`: one entry per keyframe). The first
/// keyframe, which holds the frame of the map, is never replaced.
[[nodiscard]] std::optional<ReplacedKeyframe> oldest_replaced_keyframe(
    std::span<const geometry::SE3> T_map_keyframes, const std::vector<bool>& is_in_map,
    int num_newer);

}  // namespace nodmap::slam6d
