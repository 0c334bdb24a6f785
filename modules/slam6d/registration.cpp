// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/registration/motion_solver.hpp"
#include "common/registration/rigid_fit.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;
using registration::Information;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kSettledTranslationM = 1e-4;  // a hundredth of the scanner's noise
constexpr double kSettledRotationRad = 1e-5;   // 0.1 mm at 10 m
// Farthest correspondence, in voxels: half of one is always found, 1.5 is the most that can be.
constexpr float kMaxCorrespondenceVoxels = 1.5F;
// Of a voxel mean, in variances of one measured point: however many points, the means of two clouds
// are not those of the same points.
constexpr float kRoundingVariance = 0.1F;
// Residuals below this are the rounding of voxel means, not knowledge.
constexpr double kMinResidualM = 2e-3;

// Rotation vector of a rotation.
Eigen::Vector3d log_rotation(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd angle_axis(rotation);
  return angle_axis.angle() * angle_axis.axis();
}

Eigen::Matrix3d exp_rotation(const Eigen::Vector3d& vector) {
  const double angle_rad = vector.norm();
  return angle_rad > 0.0 ? Eigen::AngleAxisd(angle_rad, vector / angle_rad).toRotationMatrix()
                         : Eigen::Matrix3d::Identity();
}

// A small motion about the base's position, axes of map.
SE3 moved(const SE3& T_map_base, const Vector6d& motion) {
  SE3 result = T_map_base;
  result.translation() += motion.head<3>();
  result.linear() = exp_rotation(motion.tail<3>()) * T_map_base.linear();
  return result;
}

Vector6d motion_between(const SE3& from, const SE3& to) {
  Vector6d motion;
  motion << to.translation() - from.translation(),
      log_rotation(to.linear() * from.linear().transpose());
  return motion;
}

// Weighted sums over correspondences. Row and column 6 of the product belong to the residual.
class ResidualSums {
 public:
  /// `kernel` (0..1) says how far the correspondence is believed, `precision` how well both points
  /// are known.
  void add(const Eigen::Vector3f& normal, const Eigen::Vector3f& arm, float residual_m,
           float kernel, float precision) {
    const Eigen::Vector3f moment = arm.cross(normal);
    const Eigen::Matrix<float, 8, 1> row{normal.x(), normal.y(), normal.z(), moment.x(),
                                         moment.y(), moment.z(), residual_m, 0.0F};
    part_.noalias() += (kernel * precision * row) * row.transpose();
    const Eigen::Vector4f arm_row{arm.x(), arm.y(), arm.z(), 1.0F};
    arms_part_.noalias() += (kernel * precision * arm_row) * arm_row.transpose();
    kernel_part_ += kernel;
    // Floats are summed in short parts only.
    if (++in_part_ == 256) {
      flush();
    }
  }

  void flush() {
    sums_ += part_.cast<double>();
    kernel_ += static_cast<double>(kernel_part_);
    arms_ += arms_part_.cast<double>();
    part_.setZero();
    arms_part_.setZero();
    kernel_part_ = 0.0F;
    in_part_ = 0;
  }

  [[nodiscard]] double mean_square_m2() const { return sums_(6, 6) / std::max(arms_(3, 3), 1e-9); }

  // Of the motion, in units of `scale()`.
  [[nodiscard]] Information<6> information() const {
    return {sums_.topLeftCorner<6, 6>(), sums_.block<6, 1>(0, 6)};
  }

  // What normals that err by `normal_error_rad` in any direction make up: the mean of J J^T for
  // J = (e, arm x e) with random e.
  [[nodiscard]] Matrix6d imitated_information(double normal_error_rad) const {
    Matrix6d H;
    const Eigen::Vector3d arm = arms_.block<3, 1>(0, 3);
    Eigen::Matrix3d cross;
    cross << 0.0, -arm.z(), arm.y(), arm.z(), 0.0, -arm.x(), -arm.y(), arm.x(), 0.0;
    const Eigen::Matrix3d arm_squares = arms_.topLeftCorner<3, 3>();
    H.topLeftCorner<3, 3>() = arms_(3, 3) * Eigen::Matrix3d::Identity();
    H.bottomLeftCorner<3, 3>() = cross;
    H.topRightCorner<3, 3>() = cross.transpose();
    H.bottomRightCorner<3, 3>() = arm_squares.trace() * Eigen::Matrix3d::Identity() - arm_squares;
    return normal_error_rad * normal_error_rad * H;
  }

  // Information of one unit, if `num_correlated` neighbours are one measurement. The residuals
  // themselves say how large their errors are.
  [[nodiscard]] double scale(double num_correlated) const {
    const double unit_variance =
        std::max(sums_(6, 6), kMinResidualM * kMinResidualM * arms_(3, 3)) /
        std::max(kernel_, 1e-9);
    return 1.0 / std::max(unit_variance * num_correlated, 1e-12);
  }

 private:
  Eigen::Matrix<double, 8, 8> sums_ = Eigen::Matrix<double, 8, 8>::Zero();
  Eigen::Matrix<float, 8, 8> part_ = Eigen::Matrix<float, 8, 8>::Zero();
  Eigen::Matrix4d arms_ = Eigen::Matrix4d::Zero();
  Eigen::Matrix4f arms_part_ = Eigen::Matrix4f::Zero();
  double kernel_ = 0.0;
  float kernel_part_ = 0.0F;
  int in_part_ = 0;
};

class SweepRegistration {
 public:
  SweepRegistration(const VoxelMap& sweep, const VoxelMap& map, const PosePrior& prior,
                    const RegistrationParams& params)
      : sweep_(sweep), map_(map), prior_(prior), params_(params) {
    result_.T_map_base = prior.T_map_base;
    prior_information_.H = prior.covariance.llt().solve(Matrix6d::Identity());
  }

  Registration run() {
    for (std::size_t l = VoxelMap::kLevels; l-- > 0;) {
      run_level(l);
    }
    classify();
    return result_;
  }

 private:
  void run_level(std::size_t l) {
    const VoxelMap::Selection selection = sweep_.select(l);
    scale_m_ = static_cast<float>(
        params_.fine_residual_scale_m *
        std::pow(params_.coarse_residual_scale_m / params_.fine_residual_scale_m,
                 static_cast<double>(l) / static_cast<double>(VoxelMap::kLevels - 1)));
    for (int i = 0; i < params_.iterations_per_level; ++i) {
      ++result_.iterations;
      const Vector6d motion =
          params_.metric == Metric::kPaper ? paper_step(selection) : plane_step(selection);
      result_.T_map_base = moved(result_.T_map_base, motion);
      if (motion.head<3>().norm() < kSettledTranslationM &&
          motion.tail<3>().norm() < kSettledRotationRad) {
        break;
      }
    }
  }

  // w_ij of Eq. 3: calls `use(point, p_map, normal_map, voxel)` for each correspondence.
  template <class Use>
  void for_each_correspondence(const VoxelMap::Selection& selection, const Use& use) const {
    const Eigen::Matrix3f R = result_.T_map_base.linear().cast<float>();
    const Eigen::Vector3f t = result_.T_map_base.translation().cast<float>();
    const auto min_cosine = static_cast<float>(params_.min_normal_cosine);
    for (std::size_t l = 0; l < VoxelMap::kLevels; ++l) {
      const VoxelGrid& grid = map_.level(l);
      const float max_m = kMaxCorrespondenceVoxels * static_cast<float>(grid.voxel_size_m());
      for (std::size_t i = selection.first_of_level[l]; i < selection.first_of_level[l + 1]; ++i) {
        const OrientedPoint& point = selection.points[i];
        const Eigen::Vector3f p_map = R * point.p + t;
        const std::uint32_t place = grid.nearest(p_map, max_m);
        if (place == VoxelGrid::kNone) {
          continue;
        }
        const Voxel& voxel = grid.voxels()[place];
        const Eigen::Vector3f normal_map = R * point.normal;
        if (normal_map.dot(voxel.normal) >= min_cosine) {
          use(point, p_map, normal_map, voxel);
        }
      }
    }
  }

  Vector6d plane_step(const VoxelMap::Selection& selection) {
    const Eigen::Vector3f p_base = result_.T_map_base.translation().cast<float>();
    const float per_sq_scale = 1.0F / (scale_m_ * scale_m_);
    ResidualSums sums;
    std::size_t num_inliers = 0;
    for_each_correspondence(selection, [&](const OrientedPoint& point, const Eigen::Vector3f& p_map,
                                           const Eigen::Vector3f& normal_map, const Voxel& voxel) {
      const Eigen::Vector3f normal = (normal_map + voxel.normal).normalized();
      const float residual_m = normal.dot(voxel.mean - p_map);
      const float relative_sq = residual_m * residual_m * per_sq_scale;
      // Means of many points are known better, but no better than the voxels' rounding.
      const float variance = 1.0F / point.num_points + 1.0F / voxel.weight + kRoundingVariance;
      const float root_kernel = 1.0F / (1.0F + relative_sq);  // Geman-McClure
      sums.add(normal, p_map - p_base, residual_m, root_kernel * root_kernel, 1.0F / variance);
      num_inliers += relative_sq < 4.0F ? 1 : 0;
    });
    sums.flush();
    result_.inlier_ratio = static_cast<double>(num_inliers) /
                           static_cast<double>(std::max<std::size_t>(1, selection.points.size()));
    result_.residual_rms_m = std::sqrt(sums.mean_square_m2());
    prior_information_.b =
        prior_information_.H * motion_between(result_.T_map_base, prior_.T_map_base);
    const double scale = sums.scale(params_.residual_correlation);
    Information<6> measurement = sums.information();
    measurement.H *= scale;
    measurement.b *= scale;
    const auto estimate = registration::solve_motion<6>(
        measurement, scale * sums.imitated_information(params_.normal_error_rad),
        prior_information_);
    result_.degenerate_directions = estimate.degenerate_directions;
    result_.covariance = estimate.covariance;
    is_valid_ = estimate.is_valid;
    return estimate.x;
  }

  // Eq. 3 as printed: the closed form knows no prior.
  Vector6d paper_step(const VoxelMap::Selection& selection) {
    std::vector<registration::PointPair> points;
    points.reserve(selection.points.size());
    double sq_sum = 0.0;
    for_each_correspondence(selection, [&](const OrientedPoint&, const Eigen::Vector3f& p_map,
                                           const Eigen::Vector3f&, const Voxel& voxel) {
      points.push_back({voxel.mean.cast<double>(), p_map.cast<double>()});
      sq_sum += static_cast<double>((voxel.mean - p_map).squaredNorm());
    });
    const auto fit = registration::fit_rigid(points);
    is_valid_ = fit.status == registration::FitStatus::kOk;
    result_.inlier_ratio = static_cast<double>(points.size()) /
                           static_cast<double>(std::max<std::size_t>(1, selection.points.size()));
    result_.residual_rms_m =
        std::sqrt(sq_sum / static_cast<double>(std::max<std::size_t>(1, points.size())));
    result_.degenerate_directions = is_valid_ ? 0 : 6;
    return motion_between(result_.T_map_base, fit.T_model_data * result_.T_map_base);
  }

  void classify() {
    const Vector6d deviation = motion_between(prior_.T_map_base, result_.T_map_base);
    result_.prior_distance =
        std::sqrt(std::max(0.0, deviation.dot(prior_information_.H * deviation)));
    const bool is_refused = !is_valid_ || result_.inlier_ratio < params_.min_inlier_ratio ||
                            !(result_.prior_distance <= params_.max_prior_distance);
    if (is_refused) {
      result_.status = RegistrationStatus::kLost;
      result_.T_map_base = prior_.T_map_base;
      result_.covariance = prior_.covariance;
    } else {
      result_.status = result_.degenerate_directions > 0 ? RegistrationStatus::kDegraded
                                                         : RegistrationStatus::kTracking;
    }
  }

  const VoxelMap& sweep_;
  const VoxelMap& map_;
  const PosePrior& prior_;
  const RegistrationParams& params_;
  Registration result_;
  Information<6> prior_information_;
  float scale_m_ = 0.0F;
  bool is_valid_ = false;
};

}  // namespace

Registration register_sweep(const VoxelMap& sweep_base, const VoxelMap& map, const PosePrior& prior,
                            const RegistrationParams& params) {
  return SweepRegistration(sweep_base, map, prior, params).run();
}

}  // namespace nodmap::slam6d
