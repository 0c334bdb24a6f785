// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <optional>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/registration/level_ground.hpp"
#include "modules/slam6d/registration/matrix6d.hpp"

namespace nodmap::slam6d {

/// Least variance of a voxel mean, as a ratio of the variance of one measured point: however many
/// points there are, the means of two clouds are not those of the same points.
inline constexpr float kRoundingVariance = 0.1F;
/// Scale of the robust kernel of the evidence that the ground is level, in standard deviations.
inline constexpr double kLevelKernel = 3.0;

/// The errors that registration minimises.
enum class ErrorMetric : std::uint8_t {
  kPointToPoint,  ///< distances between corresponding points, Eq. 3 in closed form
  kPointToPlane,  ///< distances of points to the planes of their correspondences
};

/// How far the pose of a registration can be trusted.
enum class PoseState : std::uint8_t {
  kTracking,  ///< the map determines all six directions
  kDegraded,  ///< odometry alone determines some directions
  kLost       ///< refused: it does not fit the map, or is too far from odometry
};

struct RegistrationParams {
  ErrorMetric metric = ErrorMetric::kPointToPlane;
  int iterations_per_level = 8;
  int min_planes = 50;
  double coarse_residual_scale_m = 0.15;
  double fine_residual_scale_m = 0.015;
  double min_normal_cosine = 0.8;
  double normal_error_rad = geometry::deg_to_rad(2.0);
  double residual_correlation = 10.0;
  double min_inlier_ratio = 0.2;
  double good_inlier_ratio = 0.4;
  double max_prior_distance = 6.0;
  double slip_rad = geometry::deg_to_rad(0.3);
  double bend_rad = geometry::deg_to_rad(0.2);

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("metric", metric,
             {{"point_to_point", ErrorMetric::kPointToPoint},
              {"point_to_plane", ErrorMetric::kPointToPlane}},
             "Distances that are minimised: between points (Eq. 3 of the paper), or from points to "
             "planes.");
    v.integer("iterations_per_level", iterations_per_level, {1, 1000},
              "Maximum number of iterations at each of the three voxel sizes.");
    v.integer(
        "min_planes", min_planes, {0, 100000},
        "A sweep with fewer planes, for example because somebody stands in front of the laser, "
        "neither confirms nor contradicts odometry: it is DEGRADED and follows odometry.");
    v.number("coarse_residual_scale_m", coarse_residual_scale_m, {0.001, 1.0},
             "Scale of the robust kernel at the coarsest voxels; beyond it a point loses weight.");
    v.number("fine_residual_scale_m", fine_residual_scale_m, {0.001, 1.0},
             "Scale of the robust kernel at the finest voxels.");
    v.number("min_normal_cosine", min_normal_cosine, {-1.0, 1.0},
             "Points correspond only if the cosine of the angle between their normals is at least "
             "this, so that the two sides of a door do not.");
    v.angle("normal_error_deg", normal_error_rad, {0.0, 45.0},
            "Error of a normal. Directions that are determined no better than such errors would "
            "imitate are left to odometry, for example along a bare corridor.");
    v.number("residual_correlation", residual_correlation, {1.0, 1000.0},
             "Number of neighbouring points that count as one measurement in the covariance, "
             "because their errors are correlated.");
    v.number("min_inlier_ratio", min_inlier_ratio, {0.0, 1.0},
             "A sweep is refused if less than this fraction of its points, or of its points on "
             "walls, lies on the map's planes.");
    v.number("good_inlier_ratio", good_inlier_ratio, {0.0, 1.0},
             "Below this inlier ratio other headings are tried as well, as far as odometry may be "
             "wrong.");
    v.number("max_prior_distance", max_prior_distance, {0.0, 1000.0},
             "A pose farther from odometry than this many standard deviations (Mahalanobis) is "
             "refused.");
    v.angle("slip_deg", slip_rad, {0.001, 360.0},
            "Error of the rotation that odometry counts within half a sweep, unless the wheels "
            "spin or the ground changes: evidence that keeps the map from being twisted.");
    v.angle("bend_deg", bend_rad, {0.0, 45.0},
            "How far the rotation within a sweep departs from a steady one (standard deviation); "
            "0: it is taken as steady.");
  }
};

/// The pose of the robot by odometry, with its covariances.
struct PosePrior {
  geometry::SE3 T_map_base = geometry::SE3::Identity();  ///< in the middle of the sweep
  /// Covariance at the first beam: of the base's position (m) and rotation vector (rad), axes of
  /// map.
  Matrix6d covariance = Matrix6d::Identity();
  /// Covariance of the motion from the first to the last beam; only used if the robot moved during
  /// the sweep.
  Matrix6d motion_covariance = Matrix6d::Identity();

  /// Evidence that the ground is level: the base has this height and no roll and pitch. It loses
  /// weight the more the sweep contradicts it, as on ramps or on another storey.
  struct Level {
    double height_m = 0.0;
    LevelGround ground;
  };
  std::optional<Level> level = std::nullopt;
};

struct Registration {
  PoseState state = PoseState::kLost;
  geometry::SE3 T_map_base = geometry::SE3::Identity();  ///< the prior's when lost
  MotionCorrection correction;  ///< of odometry's motion within the sweep; zero when lost
  /// Of the base's position (m) and rotation vector (rad), axes of map.
  Matrix6d covariance = Matrix6d::Identity();
  Matrix6d end_covariance = Matrix6d::Identity();        ///< the same at the last beam
  Matrix6d prior_end_covariance = Matrix6d::Identity();  ///< the same by the prior alone
  /// How far the estimate follows the sweep (the gain): identity if the prior has no weight, zero
  /// if it determines the pose alone.
  Matrix6d response = Matrix6d::Identity();
  int iterations = 0;
  double inlier_ratio = 0.0;  ///< fraction of the sweep's points that lie on the map's planes
  /// The same for the points of upright planes, which alone determine place and heading; for all
  /// points if there are hardly any of these.
  double upright_inlier_ratio = 0.0;
  [[nodiscard]] double lowest_inlier_ratio() const {
    return std::min(inlier_ratio, upright_inlier_ratio);
  }
  double residual_rms_m = 0.0;  ///< of the inliers, weighted by the robust kernel
  double prior_distance = 0.0;  ///< of the result from the prior, in standard deviations
  int degenerate_directions = 6;
  /// The robot did not move as odometry counted: the wheels slipped.
  bool is_slipped = false;

  [[nodiscard]] bool is_accepted() const { return state != PoseState::kLost; }
};

/// Finds the pose at which a sweep fits the map: iterative closest points (ICP) from coarse to fine
/// voxels. In each iteration each point of the sweep corresponds to the nearest map voxel of its
/// size. With ErrorMetric::kPointToPlane the residual is the distance along the mean of both
/// normals (symmetric objective, Rusinkiewicz 2019), weighted by a Geman-McClure kernel that
/// narrows from level to level; a Gauss-Newton step joins the residuals with the prior
/// (common/registration/motion_solver.hpp). Where a direction depends on a prior that may be
/// farther off than the finest voxels reach, correspondences are also searched for along the
/// normals.
///
/// If the robot moved during the sweep, that motion is estimated, too: as odometry plus a
/// correction that grows linearly with time (two-pose elastic: Dellenbach 2022), and at last a bend
/// of the rotation. The sweep is deskewed with it.
///
/// Starts at `T_map_start`, which may differ from the pose of the prior.
[[nodiscard]] Registration register_sweep_from(VoxelMap& sweep_base, const VoxelMap& map,
                                               const PosePrior& prior,
                                               const geometry::SE3& T_map_start,
                                               const RegistrationParams& params);

}  // namespace nodmap::slam6d
