// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/registration/registration.hpp"

namespace nodmap::slam6d {

/// A pose from which registration may start, with a rough score.
struct StartPose {
  geometry::SE3 T_map_base = geometry::SE3::Identity();
  double score = 0.0;  ///< higher if more points fit
};

/// The eight best poses, none of them near a better one.
[[nodiscard]] std::vector<StartPose> best_starts(std::vector<StartPose> tried);

/// The result of registrations from several start poses.
struct StartsResult {
  /// The registration with the most inliers, unless another place fits as well.
  std::optional<Registration> best = std::nullopt;
  bool is_ambiguous = false;  ///< another place does
};

/// Registers a sweep from each start pose. `prior_at`: returns the prior of the registration that
/// begins there. Only places for which `is_possible` holds count.
[[nodiscard]] StartsResult register_from(
    std::span<const StartPose> starts, VoxelMap& sweep_base, const VoxelMap& map,
    const std::function<PosePrior(const geometry::SE3& T_map_start)>& prior_at,
    const std::function<bool(const geometry::SE3& T_map_base)>& is_possible,
    const RegistrationParams& params);

}  // namespace nodmap::slam6d
