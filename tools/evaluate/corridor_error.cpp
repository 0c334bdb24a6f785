// SPDX-License-Identifier: BSD-3-Clause
#include "tools/evaluate/corridor_error.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "common/geometry/angle.hpp"
#include "common/geometry/se2.hpp"

namespace nodmap::evaluate {
namespace {

constexpr double kShortestM = 1.0;

}  // namespace

std::optional<CorridorErrors> measure_corridor(const std::vector<PosePair>& pairs) {
  if (pairs.empty()) {
    return std::nullopt;
  }
  const geometry::SE2 T_truth_first = geometry::to_se2(pairs.front().T_truth_base);
  const geometry::SE2 T_truth_map =
      T_truth_first * geometry::to_se2(pairs.front().T_map_base).inverse();
  const Eigen::Vector2d way =
      geometry::to_se2(pairs.back().T_truth_base).translation() - T_truth_first.translation();
  CorridorErrors errors{.length_m = way.norm()};
  if (errors.length_m < kShortestM) {
    return std::nullopt;
  }
  const Eigen::Vector2d along = way / errors.length_m;
  const Eigen::Vector2d across(-along.y(), along.x());
  for (const PosePair& pair : pairs) {
    const geometry::SE2 estimate = T_truth_map * geometry::to_se2(pair.T_map_base);
    const geometry::SE2 truth = geometry::to_se2(pair.T_truth_base);
    const Eigen::Vector2d error = estimate.translation() - truth.translation();
    errors.length_error_m = along.dot(error);
    errors.bow_m = std::max(errors.bow_m, std::abs(across.dot(error)));
    errors.heading_error_rad =
        std::max(errors.heading_error_rad, geometry::rotation_rad(estimate, truth));
  }
  return errors;
}

}  // namespace nodmap::evaluate
