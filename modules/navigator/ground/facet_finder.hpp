// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/navigator/ground/tracked_ground.hpp"
#include "modules/navigator/params.hpp"

namespace nodmap::navigator {

/// Finds the facets ahead of the robot: ramps up and down, and what is level behind them.
///
/// In a strip ahead, twice as wide as the robot, the points of each scan are averaged to patches in
/// four columns. Patches that are not on known ground become a facet if a plane fits them that is
/// long, wide and flat enough, not too steep, and meets the known ground in a kink before them. A
/// sill is too short; the floor below a kerb and a plank meet the ground nowhere; the face of a box
/// is too steep.
class FacetFinder {
 public:
  explicit FacetFinder(const LocalMapParams& params);

  /// Adds a hit of the present scan. `p_base` is the same point; it gives the place in the strip.
  void add(const Eigen::Vector3d& p_odom, const Eigen::Vector2d& p_base);
  /// Completes the scan: refines facets that are seen again, and joins a new one to the ground.
  void end_scan(TrackedGround& ground, const geometry::SE2& T_odom_base);

 private:
  static constexpr std::size_t kColumns = 4;
  /// Sums of a scan's points in one column.
  struct Column {
    int num_points = 0;
    Eigen::Vector3d sum_odom = Eigen::Vector3d::Zero();
    Eigen::Vector3d min_odom = Eigen::Vector3d::Zero();
    Eigen::Vector3d max_odom = Eigen::Vector3d::Zero();
  };
  struct Patch {
    Eigen::Vector3d p_odom;
    std::size_t column = 0;
    int scan = 0;
    bool is_above = false;
    double ahead_m = 0.0;  ///< distance ahead of base, when last sorted
  };
  struct Surface {
    PlaneFit fit;
    std::vector<Patch> patches;  ///< nearest first
    std::size_t num_within = 0;  ///< patches from its first to its last, also beside the plane
    double sum_square_m2 = 0.0;  ///< of the patches' distances from the plane they were chosen by
  };

  [[nodiscard]] bool add_patch(const Column& column, std::size_t number, TrackedGround& ground,
                               const geometry::SE2& T_odom_base);
  [[nodiscard]] bool find(bool is_above, TrackedGround& ground, const geometry::SE2& T_odom_base);
  [[nodiscard]] static std::optional<Surface> surface_from(std::span<const Patch> patches);
  [[nodiscard]] static Surface surface_on(const Plane& plane, double residual_m,
                                          std::span<const Patch> patches);
  [[nodiscard]] static bool is_large(const Surface& surface);
  [[nodiscard]] static bool is_flat(const Surface& surface);
  [[nodiscard]] static std::optional<std::size_t> facet_before(const Surface& surface,
                                                               bool is_above,
                                                               const TrackedGround& ground,
                                                               const geometry::SE2& T_odom_base);

  LocalMapParams params_;
  std::array<Column, kColumns> columns_;
  std::deque<Patch> patches_;                           // not known as ground, oldest first
  Eigen::Vector3d up_odom_ = Eigen::Vector3d::UnitZ();  // of the body, in the last scan
  int scan_ = 0;
};

}  // namespace nodmap::navigator
