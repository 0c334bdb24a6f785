// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/plane_adjustment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "common/registration/pose_edges.hpp"
#include "common/registration/robust_kernel.hpp"
#include "modules/slam6d/back_end/pose_equations.hpp"
#include "modules/slam6d/registration/level_evidence.hpp"
#include "modules/slam6d/registration/residual_sums.hpp"
#include "modules/slam6d/registration/sweep_motion.hpp"
#include "modules/slam6d/tracking/corrected_poses.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;
using Matrix63d = Eigen::Matrix<double, 6, 3>;

// A weak prior of a plane's tilts, so that a patch seen in a single line has a solution.
constexpr double kTiltDamping = 1e-4;
constexpr int kFitIterations = 4;
// The kernel of the first fit of a plane is so wide that all its points count.
constexpr double kFirstFitScale = 4.5;
// A motion that hardly any plane determined may be wrong by more than the kernel is wide. So the
// kernel of the first step is as wide as such a motion may be wrong, in standard deviations, if
// that is much wider than its scale, and at most a quarter of a patch.
constexpr double kScaleSigmas = 3.0;
constexpr double kMinScaleRatio = 2.0;
constexpr double kMaxScaleM = 0.1;
// A point is added only to a patch that its beam does not meet at a grazing angle or from behind.
constexpr float kMinViewCosine = 0.1F;

// A voxel mean of a sweep.
struct Sighting {
  Eigen::Vector3f p_map = Eigen::Vector3f::Zero();
  std::uint32_t sweep = 0;
  std::uint32_t patch = 0;
  float precision = 0.0F;  // inverse variance, relative to that of a single point
};

// What several sweeps saw of one plane.
class Patch {
 public:
  Patch(const Eigen::Vector3f& p, const Eigen::Vector3f& normal, std::vector<Sighting> sightings)
      : sightings_(std::move(sightings)) {
    place(p.cast<double>(), normal.cast<double>());
  }

  // Finds the plane of the sightings, iteratively reweighted.
  void fit(double scale_m) {
    for (int i = 0; i < kFitIterations; ++i) {
      weigh(i == 0 ? kFirstFitScale * scale_m : scale_m);
      const Eigen::Vector3d x = A_.ldlt().solve(b_);
      place(p_ + x[0] * normal_, normal_ - x[1] * u_ - x[2] * v_);
    }
    weigh(scale_m);
  }

  // Whether most of the sightings lie on one plane.
  [[nodiscard]] bool is_plane() const {
    return kernels_ > 0.5 * static_cast<double>(sightings_.size());
  }
  [[nodiscard]] double kernels() const { return kernels_; }
  [[nodiscard]] double weights() const { return A_(0, 0); }
  [[nodiscard]] double square_sum_m2() const { return square_sum_m2_; }

  // Adds the equations of the sightings to those of the poses, with the plane eliminated (Schur
  // complement).
  void add_to(PoseEquations& equations, std::span<const AdjustedSweep> sweeps, double scale) const {
    struct Part {
      std::size_t sweep;
      Matrix63d B;  // poses by plane
    };
    std::vector<Part> parts;
    for (std::size_t i = 0; i < sightings_.size(); ++i) {
      const std::size_t sweep = sightings_[i].sweep;
      if (parts.empty() || parts.back().sweep != sweep) {
        parts.push_back({sweep, Matrix63d::Zero()});
      }
      const Eigen::Vector3d p_map = sightings_[i].p_map.cast<double>();
      Vector6d J;
      J << normal_, (p_map - sweeps[sweep].T_map_base.translation()).cross(normal_);
      equations.block(sweep, sweep) += (scale * weights_[i]) * J * J.transpose();
      equations.gradient(sweep) -= (scale * weights_[i] * height(p_map)) * J;
      parts.back().B += weights_[i] * J * in_plane(p_map).transpose();
    }
    const Eigen::Matrix3d A_inverse = A_.inverse();
    for (std::size_t a = 0; a < parts.size(); ++a) {
      const Matrix63d BA = scale * parts[a].B * A_inverse;
      equations.gradient(parts[a].sweep) += BA * b_;
      for (std::size_t b = a; b < parts.size(); ++b) {
        equations.block(parts[a].sweep, parts[b].sweep) -= BA * parts[b].B.transpose();
      }
    }
  }

 private:
  void place(const Eigen::Vector3d& p, const Eigen::Vector3d& normal) {
    p_ = p;
    normal_ = normal.normalized();
    u_ = normal_.unitOrthogonal();
    v_ = normal_.cross(u_);
  }
  [[nodiscard]] double height(const Eigen::Vector3d& p_map) const {
    return normal_.dot(p_map - p_);
  }
  // The derivative of a point's height with respect to the plane's offset and tilts.
  [[nodiscard]] Eigen::Vector3d in_plane(const Eigen::Vector3d& p_map) const {
    return {1.0, u_.dot(p_map - p_), v_.dot(p_map - p_)};
  }

  // Weights and normal equations of the plane, linearised at the present plane.
  void weigh(double scale_m) {
    A_ = Eigen::Vector3d(0.0, kTiltDamping, kTiltDamping).asDiagonal();
    b_.setZero();
    weights_.clear();
    kernels_ = square_sum_m2_ = 0.0;
    for (const Sighting& sighting : sightings_) {
      const Eigen::Vector3d p_map = sighting.p_map.cast<double>();
      const double height_m = height(p_map);
      // In standard deviations: one scale for all would refuse most single points, which alone tell
      // of far walls, or accept dense means beside the plane.
      const auto precision = static_cast<double>(sighting.precision);
      const double relative = height_m * std::sqrt(precision) / scale_m;
      const double kernel = registration::geman_mcclure(relative * relative);
      const double weight = kernel * precision;
      const Eigen::Vector3d f = in_plane(p_map);
      A_ += weight * f * f.transpose();
      b_ += weight * height_m * f;
      weights_.push_back(weight);
      kernels_ += kernel;
      square_sum_m2_ += weight * height_m * height_m;
    }
  }

  std::vector<Sighting> sightings_;  // in the order of sweeps
  std::vector<double> weights_;      // of sightings_
  Eigen::Vector3d p_, normal_, u_, v_;
  Eigen::Matrix3d A_ = Eigen::Matrix3d::Identity();  // of the plane: offset, two tilts
  Eigen::Vector3d b_ = Eigen::Vector3d::Zero();
  double kernels_ = 0.0;
  double square_sum_m2_ = 0.0;
};

// Sightings, by cube.
class PatchGrid {
 public:
  PatchGrid(std::span<const AdjustedSweep> sweeps, const VoxelMapParams& voxels,
            double patch_size_m)
      : grid_(patch_size_m),
        per_trusted_sq_m2_(
            static_cast<float>(1.0 / (voxels.trusted_range_m * voxels.trusted_range_m))) {
    for (std::size_t k = 0; k < sweeps.size(); ++k) {
      add_normals(sweeps[k]);
      add_sightings(sweeps[k], static_cast<std::uint32_t>(k));
    }
  }

  // The planes that more than one sweep saw.
  [[nodiscard]] std::vector<Patch> patches(std::span<const AdjustedSweep> sweeps,
                                           double scale_m) const {
    std::vector<std::vector<Sighting>> by_patch(grid_.voxels().size());
    for (const Sighting& sighting : sightings_) {
      const Eigen::Vector3f p_base = sweeps[sighting.sweep].T_map_base.translation().cast<float>();
      if (is_of_patch(sighting, p_base)) {
        by_patch[sighting.patch].push_back(sighting);
      }
    }
    std::vector<Patch> patches;
    for (std::size_t i = 0; i < by_patch.size(); ++i) {
      if (by_patch[i].empty() || by_patch[i].front().sweep == by_patch[i].back().sweep) {
        continue;
      }
      Patch patch(grid_.voxels()[i].mean, grid_.voxels()[i].normal, std::move(by_patch[i]));
      patch.fit(scale_m);
      if (patch.is_plane()) {
        patches.push_back(std::move(patch));
      }
    }
    return patches;
  }

 private:
  [[nodiscard]] float trust(const Eigen::Vector3f& p_base) const {
    return 1.0F / (1.0F + p_base.squaredNorm() * per_trusted_sq_m2_);
  }

  // Sparse surfaces have planes at coarse voxels only.
  void add_normals(const AdjustedSweep& sweep) {
    const Eigen::Isometry3f T_map_base = sweep.T_map_base.cast<float>();
    constexpr float kHardlyAny = 1e-3F;  // the means are those of the finest voxels
    for (const OrientedPoint& point : sweep.planes) {
      const std::uint32_t patch = grid_.add(T_map_base * point.p, kHardlyAny);
      if (patch != VoxelGrid::kNone) {
        grid_.add_normal(patch, T_map_base.linear() * point.normal, trust(point.p));
      }
    }
  }

  void add_sightings(const AdjustedSweep& sweep, std::uint32_t k) {
    const Eigen::Isometry3f T_map_base = sweep.T_map_base.cast<float>();
    for (const MeanPoint& point : sweep.points) {
      Sighting sighting{
          .p_map = T_map_base * point.p,
          .sweep = k,
          .precision = trust(point.p) / (1.0F / point.num_points + kRoundingVariance)};
      sighting.patch = grid_.add(sighting.p_map, sighting.precision);
      if (sighting.patch != VoxelGrid::kNone) {
        sightings_.push_back(sighting);
      }
    }
  }

  [[nodiscard]] bool is_of_patch(const Sighting& sighting, const Eigen::Vector3f& p_base) const {
    const Eigen::Vector3f& normal = grid_.voxels()[sighting.patch].normal;
    const Eigen::Vector3f view = p_base - sighting.p_map;
    return normal.dot(view) > kMinViewCosine * view.norm();
  }

  VoxelGrid grid_;
  float per_trusted_sq_m2_;
  std::vector<Sighting> sightings_;
};

void add_patches(PoseEquations& equations, std::span<const AdjustedSweep> sweeps,
                 std::span<const Patch> patches, double num_correlated) {
  double kernels = 0.0;
  double weights = 0.0;
  double square_sum_m2 = 0.0;
  for (const Patch& patch : patches) {
    kernels += patch.kernels();
    weights += patch.weights();
    square_sum_m2 += patch.square_sum_m2();
  }
  // The variance of the residuals is estimated from the residuals.
  const double scale =
      kernels /
      (std::max({square_sum_m2, kMinResidualM * kMinResidualM * weights, 1e-12}) * num_correlated);
  for (const Patch& patch : patches) {
    patch.add_to(equations, sweeps, scale);
  }
}

// Adds the motion from an earlier sweep to sweep `k`.
void add_odometry(PoseEquations& equations, std::span<const AdjustedSweep> sweeps, std::size_t k) {
  const std::size_t from = sweeps[k].from;
  const SE3& T_map_from = sweeps[from].T_map_base;
  const SE3& T_map_this = sweeps[k].T_map_base;
  const SE3 T_map_counted = T_map_from * sweeps[k].T_from_this;
  const Vector6d error = motion_between(T_map_counted, T_map_this);
  const Matrix6d information = registration::inverse(sweeps[k].covariance);
  const Matrix6d J_from =
      -registration::moment_arm_jacobian(T_map_this.translation() - T_map_from.translation());
  equations.block(from, from) += J_from.transpose() * information * J_from;
  equations.block(from, k) += J_from.transpose() * information;
  equations.block(k, k) += information;
  equations.gradient(from) -= J_from.transpose() * information * error;
  equations.gradient(k) -= information * error;
}

// The largest standard deviation of a position in the motions between sweeps.
double largest_sigma_m(std::span<const AdjustedSweep> sweeps) {
  double variance_m2 = 0.0;
  for (std::size_t k = 1; k < sweeps.size(); ++k) {
    const Eigen::Matrix3d position = sweeps[k].covariance.topLeftCorner<3, 3>();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(position,
                                                                    Eigen::EigenvaluesOnly);
    variance_m2 = std::max(variance_m2, directions.eigenvalues()[2]);
  }
  return std::sqrt(variance_m2);
}

// One Gauss-Newton step.
void step(std::vector<AdjustedSweep>& sweeps, const VoxelMapParams& voxels,
          const RegistrationParams& registration, double patch_size_m, double scale_m) {
  if (sweeps.size() < 2) {
    return;
  }
  const std::vector<Patch> patches =
      PatchGrid(sweeps, voxels, patch_size_m).patches(sweeps, scale_m);
  PoseEquations equations(sweeps.size());
  add_patches(equations, sweeps, patches, registration.residual_correlation);
  for (std::size_t k = 1; k < sweeps.size(); ++k) {
    add_odometry(equations, sweeps, k);
    if (sweeps[k].level) {
      const auto level = level_evidence(*sweeps[k].level, sweeps[k].T_map_base);
      equations.block(k, k) += level.H;
      equations.gradient(k) += level.b;
    }
  }
  const auto motions = equations.solve();
  for (std::size_t k = 0; motions && k < sweeps.size(); ++k) {
    SE3& pose = sweeps[k].T_map_base;
    pose = normalized(moved(pose, motions->segment<6>(static_cast<Eigen::Index>(6 * k))));
  }
}

}  // namespace

std::vector<MeanPoint> adjusted_points(std::span<const Eigen::Vector3f> points,
                                       const AdjustmentParams& params) {
  VoxelGrid grid(params.voxel_size_m);
  grid.add(points);
  std::vector<MeanPoint> means;
  means.reserve(grid.voxels().size());
  for (const Voxel& voxel : grid.voxels()) {
    means.push_back({voxel.mean, voxel.weight});
  }
  return means;
}

std::vector<SE3> adjust_planes(std::vector<AdjustedSweep> sweeps, const VoxelMapParams& voxels,
                               const RegistrationParams& registration,
                               const AdjustmentParams& params) {
  const double wide_scale_m = std::min(kMaxScaleM, kScaleSigmas * largest_sigma_m(sweeps));
  if (wide_scale_m > kMinScaleRatio * params.residual_scale_m) {
    step(sweeps, voxels, registration, params.patch_size_m, wide_scale_m);
  }
  step(sweeps, voxels, registration, params.patch_size_m, params.residual_scale_m);
  std::vector<SE3> poses;
  poses.reserve(sweeps.size());
  for (const AdjustedSweep& sweep : sweeps) {
    poses.push_back(sweep.T_map_base);
  }
  return poses;
}

}  // namespace nodmap::slam6d
