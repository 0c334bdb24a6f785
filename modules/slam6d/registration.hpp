// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "modules/slam6d/pose_covariance.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// Of a voxel mean, in variances of one measured point: however many points, the means of two
/// clouds are not those of the same points.
inline constexpr float kRoundingVariance = 0.1F;
/// Scale of the kernel that says how far the ground is believed to be level, in standard
/// deviations.
inline constexpr double kLevelKernel = 3.0;

/// What the registration makes small.
enum class Metric {
  kPaper,  ///< distances between corresponding points, Eq. 3 in closed form
  kPlanes  ///< distances of points to the planes of their correspondences
};

/// Whether a registration may be believed.
enum class RegistrationStatus {
  kTracking,  ///< all six directions are held by the map
  kDegraded,  ///< some directions are held by odometry alone
  kLost       ///< refused: it does not fit the map, or is too far from odometry
};

struct RegistrationParams {
  Metric metric = Metric::kPlanes;
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

  template <class Visitor>
  void describe(Visitor& v) {
    v.choice("metric", metric, {{"paper", Metric::kPaper}, {"planes", Metric::kPlanes}},
             "What is made small: distances between points (Eq. 3), or from points to planes.");
    v.integer("iterations_per_level", iterations_per_level, {1, 1000},
              "Most iterations at each of the three voxel sizes.");
    v.integer("min_planes", min_planes, {0, 100000},
              "A sweep with fewer planes tells nothing for or against odometry, as somebody stands "
              "before the laser: DEGRADED, by odometry.");
    v.number("coarse_residual_scale_m", coarse_residual_scale_m, {0.001, 1.0},
             "Scale of the robust kernel at the coarsest voxels; beyond it a point loses weight.");
    v.number("fine_residual_scale_m", fine_residual_scale_m, {0.001, 1.0},
             "The same at the finest voxels.");
    v.number("min_normal_cosine", min_normal_cosine, {-1.0, 1.0},
             "Points correspond only when the cosine between their normals is at least this: the "
             "two sides of a door do not.");
    v.angle("normal_error_deg", normal_error_rad, {0.0, 45.0},
            "Error of a normal. What a scene holds no better than such errors seem to hold it is "
            "left to odometry: the length of a bare corridor.");
    v.number("residual_correlation", residual_correlation, {1.0, 1000.0},
             "Neighbouring points share their errors: so many of them count as one measurement in "
             "the covariance.");
    v.number("min_inlier_ratio", min_inlier_ratio, {0.0, 1.0},
             "A sweep of whose points, or of whose points on walls, a smaller part lies on the "
             "map's planes is refused.");
    v.number("good_inlier_ratio", good_inlier_ratio, {0.0, 1.0},
             "Below it other headings are tried as well, as far as odometry may be wrong.");
    v.number("max_prior_distance", max_prior_distance, {0.0, 1000.0},
             "A pose farther from odometry than this many standard deviations (Mahalanobis) is "
             "refused.");
  }
};

/// Where odometry says the robot is, and how sure that is.
struct PosePrior {
  geometry::SE3 T_map_base = geometry::SE3::Identity();  ///< in the middle of the sweep
  /// At the first beam; of the base's position (m) and rotation vector (rad), axes of map.
  Matrix6d covariance = Matrix6d::Identity();
  /// Of the motion from the first to the last beam; only for a sweep on the move.
  Matrix6d motion_covariance = Matrix6d::Identity();

  /// That the ground is level: the base is at this height, roll and pitch, as far as nothing else
  /// is seen. Believed less the more the sweep contradicts it: ramps, another storey.
  struct Level {
    double height_m = 0.0;
    double height_sigma_m = 0.02;
    double tilt_sigma_rad = 0.005;
  };
  std::optional<Level> level = std::nullopt;
};

struct Registration {
  RegistrationStatus status = RegistrationStatus::kLost;
  geometry::SE3 T_map_base = geometry::SE3::Identity();  ///< the prior's when lost
  MotionCorrection correction;  ///< of odometry's motion within the sweep; zero when lost
  /// Of the base's position (m) and rotation vector (rad), axes of map.
  Matrix6d covariance = Matrix6d::Identity();
  Matrix6d end_covariance = Matrix6d::Identity();        ///< the same at the last beam
  Matrix6d prior_end_covariance = Matrix6d::Identity();  ///< the same by the prior alone
  /// How far the estimate follows the sweep: the identity where the prior says nothing, zero where
  /// it says all.
  Matrix6d response = Matrix6d::Identity();
  int iterations = 0;
  double inlier_ratio = 0.0;  ///< part of the sweep's points that lie on the map's planes
  /// The same of the points of upright planes, which alone tell place and heading; of all points
  /// where there are hardly any.
  double upright_inlier_ratio = 0.0;
  [[nodiscard]] double lowest_inlier_ratio() const {
    return std::min(inlier_ratio, upright_inlier_ratio);
  }
  double residual_rms_m = 0.0;  ///< of the inliers, weighted by the robust kernel
  double prior_distance = 0.0;  ///< of the result from the prior, in standard deviations
  int degenerate_directions = 6;

  [[nodiscard]] bool is_accepted() const { return status != RegistrationStatus::kLost; }
};

/// Finds the pose at which a sweep lies on the map: iterative closest points from coarse to fine
/// voxels. Per iteration each point of the sweep corresponds to the
/// nearest map voxel of its size. With Metric::kPlanes the residual is taken along the mean of both
/// normals (symmetric objective, Rusinkiewicz 2019), weighted by a Geman-McClure kernel that
/// narrows from level to level; a Gauss-Newton step joins the residuals with the prior as evidence
/// (motion_solver). Where a direction is left to a prior that may be farther off than the finest
/// voxels reach, these look for their correspondences along their normals.
///
/// Of a sweep on the move the motion within it is estimated, too, as odometry with a correction
/// that grows evenly with time (two-pose elastic: Dellenbach 2022), and the sweep is deskewed with
/// it.
///
/// Starts at `T_map_start`, which may lie away from the prior.
[[nodiscard]] Registration register_sweep_from(VoxelMap& sweep_base, const VoxelMap& map,
                                               const PosePrior& prior,
                                               const geometry::SE3& T_map_start,
                                               const RegistrationParams& params);

/// The same from where the prior is. Where too few points fit, other headings are tried: wheels
/// that spin against something count a rotation that never was.
[[nodiscard]] Registration register_sweep(VoxelMap& sweep_base, const VoxelMap& map,
                                          const PosePrior& prior, const RegistrationParams& params);

}  // namespace nodmap::slam6d
