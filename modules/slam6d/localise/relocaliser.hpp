// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/registration/start_poses.hpp"

namespace nodmap::slam6d {

/// Where in a map the robot is searched for, and when a place is believed.
struct RelocaliserParams {
  double min_inlier_ratio = 0.5;
  double max_contradiction_ratio = 0.02;
  double max_missing_ratio = 0.005;
  double reach_m = 1.2;
  double step_m = 0.3;
  double heading_step_rad = geometry::deg_to_rad(5.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("min_inlier_ratio", min_inlier_ratio, {0.0, 1.0},
             "A place is believed only if at least this fraction of the sweep's points, and of its "
             "points on walls, lies on the map's planes.");
    v.number("max_contradiction_ratio", max_contradiction_ratio, {0.0, 1.0},
             "A place is not believed if more than this fraction of the sweep's surfaces, where "
             "the map has been seen, lies where the map's beams passed through.");
    v.number("max_missing_ratio", max_missing_ratio, {0.0, 1.0},
             "A place is not believed if more than this fraction of the map's surfaces around the "
             "robot is missing: the robot's beams pass through them.");
    v.number(
        "search_reach_m", reach_m, {0.0, 100.0},
        "The robot is searched for up to this distance from the poses at which the map was made.");
    v.number("search_step_m", step_m, {0.05, 2.0}, "Distance between the positions tried.");
    v.angle("search_heading_step_deg", heading_step_rad, {0.5, 45.0},
            "Angle between the headings tried.");
  }
};

/// Finds the place of a sweep in a whole map without a start pose. Tries positions near all poses
/// from which the map was made, in all headings. The robot is assumed to have the height and tilt
/// that it had there.
class Relocaliser {
 public:
  /// `T_map_keyframes`: the poses from which the map was made.
  Relocaliser(const RelocaliserParams& params, const RegistrationParams& registration,
              std::span<const geometry::SE3> T_map_keyframes, const VoxelMap& map);

  /// Returns the pose of the sweep, with voxels `sweep_base`, in the map. `is_possible`: whether it
  /// may be at a pose.
  [[nodiscard]] StartsResult find(
      const VoxelMap& sweep_base, const VoxelMap& map,
      const std::function<bool(const geometry::SE3& T_map_base)>& is_possible) const;

 private:
  /// The cells that are near a wall of the map, within about one and a half cells, one byte each.
  /// Only walls determine place and heading: floor and ceiling fit everywhere.
  struct WallCells {
    WallCells(const VoxelMap& map, float edge_m);
    [[nodiscard]] bool is_near_wall(const Eigen::Vector3f& p_map) const;
    [[nodiscard]] std::size_t index_of(const Eigen::Vector3i& cell) const;

    float cell_m;
    Eigen::Vector3f p_first = Eigen::Vector3f::Zero();  ///< lowest corner
    Eigen::Vector3i size = Eigen::Vector3i::Zero();     ///< cells
    std::vector<std::uint8_t> near_wall;
  };
  struct WallPoint {
    Eigen::Vector3f p;
    std::size_t level;  ///< of `cells_` in which it is looked up
  };

  [[nodiscard]] std::vector<WallPoint> wall_points(const VoxelMap& sweep_base) const;
  /// The fraction of wall points that are near a wall of the map; of every `stride`th point.
  [[nodiscard]] double part_near_walls(std::span<const WallPoint> walls_rotated,
                                       const Eigen::Vector3f& p_map_base, std::size_t stride) const;
  [[nodiscard]] std::vector<StartPose> try_all(std::span<const WallPoint> walls_base) const;
  [[nodiscard]] PosePrior prior_at(const geometry::SE3& T_map_start) const;

  RelocaliserParams params_;
  RegistrationParams registration_;
  /// Cells of increasing size, each twice as large as the one before: a heading step moves a point
  /// farther the more distant it is.
  std::vector<WallCells> cells_;
  std::vector<Eigen::Vector3d> places_;  ///< positions to be tried
};

}  // namespace nodmap::slam6d
