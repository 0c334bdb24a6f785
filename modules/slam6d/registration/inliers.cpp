// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration/inliers.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nodmap::slam6d {
namespace {

// With fewer upright points than this, their ratio means nothing.
constexpr std::size_t kMinUprightPoints = 100;
constexpr std::size_t kMinAcrossPoints = 50;

struct InlierCount {
  std::size_t points = 0;
  std::size_t inliers = 0;

  void add(bool is_inlier) {
    ++points;
    inliers += is_inlier ? 1 : 0;
  }
  [[nodiscard]] double ratio() const {
    return static_cast<double>(inliers) / static_cast<double>(std::max<std::size_t>(1, points));
  }
};

// Calls `use(normal_map, is_inlier)` for each point; is_inlier() searches the map.
template <class Use>
void for_each_point(const VoxelMap::Selection& sweep, const CorrespondenceSearch& map,
                    const geometry::SE3& T_map_base, double max_m, const Use& use) {
  const Eigen::Matrix3f R = T_map_base.linear().cast<float>();
  const Eigen::Vector3f t = T_map_base.translation().cast<float>();
  for (std::size_t l = 0; l < VoxelMap::kLevels; ++l) {
    for (std::size_t i = sweep.first_of_level[l]; i < sweep.first_of_level[l + 1]; ++i) {
      const OrientedPoint& point = sweep.points[i];
      const Eigen::Vector3f p_map = R * point.p + t;
      const Eigen::Vector3f normal_map = R * point.normal;
      use(normal_map, [&] {
        return map.fit(l, p_map, normal_map, static_cast<float>(max_m)) == FitToPlane::kOn;
      });
    }
  }
}

}  // namespace

InlierRatios count_inliers(const VoxelMap::Selection& sweep, const CorrespondenceSearch& map,
                           const geometry::SE3& T_map_base, double max_m) {
  InlierCount all;
  InlierCount upright;
  for_each_point(sweep, map, T_map_base, max_m,
                 [&](const Eigen::Vector3f& normal_map, const auto& is_inlier) {
                   const bool is_in = is_inlier();
                   all.add(is_in);
                   if (is_upright(normal_map.z())) {
                     upright.add(is_in);
                   }
                 });
  return {.all = all.ratio(),
          .upright = upright.points < kMinUprightPoints ? all.ratio() : upright.ratio()};
}

std::optional<double> inlier_ratio_across(const VoxelMap::Selection& sweep,
                                          const CorrespondenceSearch& map,
                                          const geometry::SE3& T_map_base,
                                          const Eigen::Vector3d& direction_map, double max_m) {
  constexpr float kMinCosine = 0.5F;
  const Eigen::Vector3f direction = direction_map.cast<float>();
  InlierCount across;
  for_each_point(
      sweep, map, T_map_base, max_m, [&](const Eigen::Vector3f& normal_map, const auto& is_inlier) {
        if (is_upright(normal_map.z()) && std::abs(normal_map.dot(direction)) > kMinCosine) {
          across.add(is_inlier());
        }
      });
  return across.points < kMinAcrossPoints ? std::nullopt : std::optional(across.ratio());
}

}  // namespace nodmap::slam6d
