// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/registration/motion_solver.hpp"
#include "common/registration/rigid_fit.hpp"
#include "modules/slam6d/pose_covariance.hpp"
#include "modules/slam6d/residual_sums.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;
using registration::Information;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;

constexpr double kSettledTranslationM = 1e-4;  // a hundredth of the scanner's noise
constexpr double kSettledRotationRad = 1e-5;   // 0.1 mm at 10 m
// Farthest correspondence, in voxels: half of one is always found, 1.5 is the most that can be.
constexpr float kMaxCorrespondenceVoxels = 1.5F;
// How far is looked along a normal: as far as the prior may be wrong.
constexpr double kNormalReachSigmas = 2.0;
constexpr double kMaxReachVoxels = 6.0;

// A small motion about the base's position, axes of map.
SE3 moved(const SE3& T_map_base, const Vector6d& motion) {
  SE3 result = T_map_base;
  result.translation() += motion.head<3>();
  result.linear() = geometry::rotation_of(motion.tail<3>()) * T_map_base.linear();
  return result;
}

Vector6d motion_between(const SE3& from, const SE3& to) {
  Vector6d motion;
  motion << to.translation() - from.translation(),
      geometry::rotation_vector(to.linear() * from.linear().transpose());
  return motion;
}

// What the prior says of the motion of the middle of the sweep, and, for N = 12, of what is to be
// added to it per unit of time: from the covariances of the pose at the first beam and of the
// motion to the last one. All of them small motions about the base's position, axes of map.
template <int N>
Eigen::Matrix<double, N, N> motion_covariance(const PosePrior& prior, const SE3& T_map_base,
                                              const Eigen::Vector3f& half_path) {
  if constexpr (N == 6) {
    return prior.covariance;
  } else {
    // A rotation at the first beam moves the base at the last one.
    Matrix6d by_rotation = Matrix6d::Zero();
    by_rotation.topRightCorner<3, 3>() = -skew(T_map_base.linear() * half_path.cast<double>());
    Matrix12d from_ends = 0.5 * Matrix12d::Identity();
    from_ends.topLeftCorner<6, 6>() = Matrix6d::Identity() + by_rotation;
    from_ends.topRightCorner<6, 6>() = 0.5 * Matrix6d::Identity();
    from_ends.bottomLeftCorner<6, 6>() = by_rotation;
    Matrix12d ends = Matrix12d::Zero();
    ends.topLeftCorner<6, 6>() = prior.covariance;
    ends.bottomRightCorner<6, 6>() = prior.motion_covariance;
    return from_ends * ends * from_ends.transpose();
  }
}

// Fewer upright points than this tell nothing of their own.
constexpr std::size_t kMinUprightPoints = 100;

bool is_upright(float normal_up) {
  return std::abs(normal_up) < 0.5F;
}

struct InlierCount {
  std::size_t points = 0;
  std::size_t inliers = 0;

  [[nodiscard]] double ratio() const {
    return static_cast<double>(inliers) / static_cast<double>(std::max<std::size_t>(1, points));
  }
};

// Of a stationary sweep (N = 6) or one on the move (N = 12).
template <int N>
class SweepRegistration {
 public:
  SweepRegistration(VoxelMap& sweep, const VoxelMap& map, const PosePrior& prior,
                    const SE3& T_map_start, const RegistrationParams& params)
      : sweep_(sweep), map_(map), prior_(prior), params_(params) {
    result_.T_map_base = T_map_start;
    const Matrix covariance = motion_covariance<N>(prior, prior.T_map_base, sweep.half_path());
    prior_information_.H = covariance.llt().solve(Matrix::Identity());
    prior_covariance_ = covariance.template topLeftCorner<6, 6>();
    result_.prior_end_covariance = end_covariance(covariance);
  }

  Registration run() {
    for (std::size_t l = VoxelMap::kLevels; l-- > 0;) {
      run_level(l, kernel_scale(l, params_.coarse_residual_scale_m));
    }
    count_inliers();
    if (is_left_open() && params_.metric == Metric::kPlanes) {
      look_along_normals();
    }
    classify();
    return result_;
  }

 private:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  // Whether a direction is held by the prior alone, and may be farther off than the finest voxels
  // find correspondences.
  [[nodiscard]] bool is_left_open() const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
        result_.covariance.topLeftCorner<3, 3>(), Eigen::EigenvaluesOnly);
    const double reach_m =
        static_cast<double>(kMaxCorrespondenceVoxels) * map_.level(0).voxel_size_m();
    return result_.degenerate_directions > 0 && eigen.eigenvalues()[2] > reach_m * reach_m;
  }

  // A strip of floor before a wall is too narrow for planes in coarse voxels, and too far off for
  // the finest ones: these look for it along their normals. Taken when it holds more directions
  // and the sweep fits no worse.
  void look_along_normals() {
    const Registration before = result_;
    std::optional<VoxelMap> sweep_before;
    if constexpr (N == 12) {
      sweep_before = sweep_;
    }
    const double voxel_size_m = map_.level(0).voxel_size_m();
    const double reach_m =
        std::min(kNormalReachSigmas * std::sqrt(prior_covariance_.diagonal().head<3>().maxCoeff()),
                 kMaxReachVoxels * voxel_size_m);
    steps_along_normal_ = static_cast<int>(std::ceil(reach_m / voxel_size_m));
    for (std::size_t l = VoxelMap::kLevels; l-- > 0;) {
      run_level(0, kernel_scale(l, std::max(reach_m, params_.coarse_residual_scale_m)));
    }
    steps_along_normal_ = 0;
    count_inliers();
    if (!is_valid_ || result_.degenerate_directions >= before.degenerate_directions ||
        result_.lowest_inlier_ratio() < before.lowest_inlier_ratio()) {
      result_ = before;
      is_valid_ = true;
      if constexpr (N == 12) {
        sweep_ = std::move(*sweep_before);
      }
    }
  }

  // The kernel narrows evenly from level to level.
  [[nodiscard]] double kernel_scale(std::size_t l, double coarse_scale_m) const {
    return params_.fine_residual_scale_m *
           std::pow(coarse_scale_m / params_.fine_residual_scale_m,
                    static_cast<double>(l) / static_cast<double>(VoxelMap::kLevels - 1));
  }

  void run_level(std::size_t l, double scale_m) {
    level_ = l;
    const VoxelMap::Selection selection = select(l);
    scale_m_ = static_cast<float>(scale_m);
    for (int i = 0; i < params_.iterations_per_level; ++i) {
      ++result_.iterations;
      const Vector motion =
          params_.metric == Metric::kPaper ? paper_step(selection) : plane_step(selection);
      if constexpr (N == 12) {
        const Eigen::Matrix3d R_base_map = result_.T_map_base.linear().transpose();
        since_deskew_.translation_m += R_base_map * motion.template segment<3>(6);
        since_deskew_.rotation_rad += R_base_map * motion.template segment<3>(9);
      }
      result_.T_map_base = moved(result_.T_map_base, motion.template head<6>());
      if (motion.template head<3>().norm() < kSettledTranslationM &&
          motion.template segment<3>(3).norm() < kSettledRotationRad) {
        break;
      }
    }
    deskew();
  }

  // The planes of a sweep that is deskewed wrongly are tilted: they are found anew.
  void deskew() {
    if constexpr (N == 12) {
      sweep_.correct(since_deskew_);
      result_.correction.translation_m += since_deskew_.translation_m;
      result_.correction.rotation_rad += since_deskew_.rotation_rad;
      since_deskew_ = {};
    }
  }

  // What the prior says about the motion that is still to be made.
  [[nodiscard]] Vector prior_motion() const {
    Vector motion;
    motion.template head<6>() = motion_between(result_.T_map_base, prior_.T_map_base);
    if constexpr (N == 12) {
      const Eigen::Matrix3d& R_map_base = result_.T_map_base.linear();
      motion.template segment<3>(6) =
          -R_map_base * (result_.correction.translation_m + since_deskew_.translation_m);
      motion.template segment<3>(9) =
          -R_map_base * (result_.correction.rotation_rad + since_deskew_.rotation_rad);
    }
    return motion;
  }

  // The prior with the evidence that the ground is level, at the present pose.
  [[nodiscard]] Information<N> prior_here() const {
    Information<N> prior{prior_information_.H, prior_information_.H * prior_motion()};
    // What is seen comes first: from coarse voxels.
    if (prior_.level && level_ == 0) {
      const SE3& T_map_base = result_.T_map_base;
      // From the base's z axis to that of map.
      const Eigen::Vector3d tilt = T_map_base.linear().col(2).cross(Eigen::Vector3d::UnitZ());
      const double height_m = prior_.level->height_m - T_map_base.translation().z();
      const auto add = [&prior](int i, double deviation, double sigma) {
        const double relative = deviation / (kLevelKernel * sigma);
        const double root_kernel = 1.0 / (1.0 + relative * relative);  // Geman-McClure
        const double information = root_kernel * root_kernel / (sigma * sigma);
        prior.H(i, i) += information;
        prior.b(i) += information * deviation;
      };
      add(2, height_m, prior_.level->height_sigma_m);
      add(3, tilt.x(), prior_.level->tilt_sigma_rad);
      add(4, tilt.y(), prior_.level->tilt_sigma_rad);
    }
    return prior;
  }

  VoxelMap::Selection select(std::size_t l) {
    VoxelMap::Selection selection = sweep_.select(l);
    matches_.assign(selection.points.size(), {});
    return selection;
  }

  // The map's voxel nearest to a point of the selection. From step to step points hardly move, and
  // the nearest stays the same.
  std::uint32_t match(std::size_t i, const VoxelGrid& grid, const Eigen::Vector3f& p_map,
                      const Eigen::Vector3f& normal_map) {
    Match& last = matches_[i];
    if (!((p_map - last.p_map).squaredNorm() < last.sq_slack_m2)) {
      const auto voxel_size_m = static_cast<float>(grid.voxel_size_m());
      const float max_m = kMaxCorrespondenceVoxels * voxel_size_m;
      VoxelGrid::Nearest nearest = grid.find_nearest(p_map, max_m);
      for (int k = 1; k <= 2 * steps_along_normal_ && !corresponds(nearest, grid, normal_map);
           ++k) {
        // 1, -1, 2, -2, ...
        const auto step = static_cast<float>(k % 2 == 1 ? (k + 1) / 2 : -k / 2);
        nearest = grid.find_nearest(p_map + step * voxel_size_m * normal_map, max_m);
      }
      last = {p_map, nearest.slack_m * nearest.slack_m, nearest.place};
    }
    return last.place;
  }

  [[nodiscard]] bool corresponds(const VoxelGrid::Nearest& nearest, const VoxelGrid& grid,
                                 const Eigen::Vector3f& normal_map) const {
    return nearest.place != VoxelGrid::kNone &&
           normal_map.dot(grid.voxels()[nearest.place].normal) >=
               static_cast<float>(params_.min_normal_cosine);
  }

  // w_ij of Eq. 3: calls `use(point, p_map, normal_map, voxel)` for each correspondence.
  template <class Use>
  void for_each_correspondence(const VoxelMap::Selection& selection, const Use& use) {
    const Eigen::Matrix3f R = result_.T_map_base.linear().cast<float>();
    const Eigen::Vector3f t = result_.T_map_base.translation().cast<float>();
    const Eigen::Vector3f step = since_deskew_.translation_m.cast<float>();
    const Eigen::Vector3f turn = since_deskew_.rotation_rad.cast<float>();
    const auto min_cosine = static_cast<float>(params_.min_normal_cosine);
    for (std::size_t l = 0; l < VoxelMap::kLevels; ++l) {
      const VoxelGrid& grid = map_.level(l);
      for (std::size_t i = selection.first_of_level[l]; i < selection.first_of_level[l + 1]; ++i) {
        const OrientedPoint& point = selection.points[i];
        Eigen::Vector3f p_base = point.p;
        if constexpr (N == 12) {
          p_base += point.time * (step + turn.cross(point.p - point.time * sweep_.half_path()));
        }
        const Eigen::Vector3f p_map = R * p_base + t;
        const Eigen::Vector3f normal_map = R * point.normal;
        const std::uint32_t place = match(i, grid, p_map, normal_map);
        if (place == VoxelGrid::kNone) {
          continue;
        }
        const Voxel& voxel = grid.voxels()[place];
        if (normal_map.dot(voxel.normal) >= min_cosine) {
          use(point, p_map, normal_map, voxel);
        }
      }
    }
  }

  Vector plane_step(const VoxelMap::Selection& selection) {
    const Eigen::Vector3f p_base = result_.T_map_base.translation().cast<float>();
    const Eigen::Vector3f half_path =
        result_.T_map_base.linear().cast<float>() * sweep_.half_path();
    const float per_sq_scale = 1.0F / (scale_m_ * scale_m_);
    ResidualSums<N> sums;
    for_each_correspondence(selection, [&](const OrientedPoint& point, const Eigen::Vector3f& p_map,
                                           const Eigen::Vector3f& normal_map, const Voxel& voxel) {
      const Eigen::Vector3f normal = (normal_map + voxel.normal).normalized();
      const float residual_m = normal.dot(voxel.mean - p_map);
      const float relative_sq = residual_m * residual_m * per_sq_scale;
      // Means of many points are known better, but no better than the voxels' rounding.
      const float variance = 1.0F / point.num_points + 1.0F / voxel.weight + kRoundingVariance;
      const float root_kernel = 1.0F / (1.0F + relative_sq);  // Geman-McClure
      // From where the base was at that time.
      const Eigen::Vector3f arm = p_map - p_base - point.time * half_path;
      sums.add(normal, arm, residual_m, point.time, root_kernel * root_kernel, 1.0F / variance);
    });
    sums.flush();
    result_.residual_rms_m = std::sqrt(sums.mean_square_m2());
    const double scale = sums.scale(params_.residual_correlation);
    Information<N> measurement = sums.information();
    measurement.H *= scale;
    measurement.b *= scale;
    const Information<N> prior = prior_here();
    const auto estimate = registration::solve_motion<N>(
        measurement, scale * sums.imitated_information(params_.normal_error_rad), prior);
    result_.response =
        Matrix6d::Identity() - (estimate.covariance * prior.H).template topLeftCorner<6, 6>();
    result_.degenerate_directions = degenerate_directions(estimate.covariance);
    result_.covariance = estimate.covariance.template topLeftCorner<6, 6>();
    result_.end_covariance = end_covariance(estimate.covariance);
    is_valid_ = estimate.is_valid;
    return estimate.x;
  }

  // At the last beam: of m0 + m1.
  [[nodiscard]] static Matrix6d end_covariance(const Matrix& covariance) {
    Matrix6d end = covariance.template topLeftCorner<6, 6>();
    if constexpr (N == 12) {
      const Matrix6d cross = covariance.template topRightCorner<6, 6>();
      end += cross + cross.transpose() + covariance.template bottomRightCorner<6, 6>();
    }
    return end;
  }

  // About how many directions of the pose the map says less than the prior.
  [[nodiscard]] int degenerate_directions(const Matrix& covariance) const {
    const Matrix6d pose = covariance.template topLeftCorner<6, 6>();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> eigen(pose, prior_covariance_);
    return static_cast<int>((eigen.eigenvalues().array() > 0.5).count());
  }

  // Eq. 3 as printed: the closed form knows no prior.
  Vector paper_step(const VoxelMap::Selection& selection) {
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
    result_.residual_rms_m =
        std::sqrt(sq_sum / static_cast<double>(std::max<std::size_t>(1, points.size())));
    result_.degenerate_directions = is_valid_ ? 0 : 6;
    Vector motion = Vector::Zero();
    motion.template head<6>() =
        motion_between(result_.T_map_base, fit.T_model_data * result_.T_map_base);
    return motion;
  }

  // How much of the sweep lies on the map's planes. Floor and ceiling do at any place and heading:
  // upright planes are counted by themselves, too.
  void count_inliers() {
    const VoxelMap::Selection selection = select(0);
    const Eigen::RowVector3f up_base = result_.T_map_base.linear().row(2).cast<float>();
    InlierCount all;
    InlierCount upright;
    for (const OrientedPoint& point : selection.points) {
      ++all.points;
      upright.points += is_upright(up_base.dot(point.normal)) ? 1 : 0;
    }
    const auto max_m = static_cast<float>(2.0 * params_.fine_residual_scale_m);
    for_each_correspondence(selection, [&](const OrientedPoint& point, const Eigen::Vector3f& p_map,
                                           const Eigen::Vector3f&, const Voxel& voxel) {
      if (std::abs(voxel.normal.dot(voxel.mean - p_map)) < max_m) {
        ++all.inliers;
        upright.inliers += is_upright(up_base.dot(point.normal)) ? 1 : 0;
      }
    });
    result_.inlier_ratio = all.ratio();
    result_.upright_inlier_ratio =
        upright.points < kMinUprightPoints ? all.ratio() : upright.ratio();
  }

  void classify() {
    const Vector deviation = prior_motion();
    result_.prior_distance =
        std::sqrt(std::max(0.0, deviation.dot(prior_information_.H * deviation)));
    const bool is_refused = !is_valid_ ||
                            !(result_.lowest_inlier_ratio() >= params_.min_inlier_ratio) ||
                            !(result_.prior_distance <= params_.max_prior_distance);
    if (is_refused) {
      result_.status = RegistrationStatus::kLost;
      result_.T_map_base = prior_.T_map_base;
      result_.correction = {};
      result_.covariance = result_.end_covariance = prior_.covariance;
    } else {
      result_.status = result_.degenerate_directions > 0 ? RegistrationStatus::kDegraded
                                                         : RegistrationStatus::kTracking;
    }
  }

  // What a point corresponded to when it was looked up, and how far it may move from there.
  struct Match {
    Eigen::Vector3f p_map = Eigen::Vector3f::Zero();
    float sq_slack_m2 = 0.0F;
    std::uint32_t place = VoxelGrid::kNone;
  };

  VoxelMap& sweep_;
  const VoxelMap& map_;
  const PosePrior& prior_;
  const RegistrationParams& params_;
  Registration result_;
  Information<N> prior_information_;
  Matrix6d prior_covariance_;      // of the pose in the middle of the sweep
  MotionCorrection since_deskew_;  // not yet in the sweep's voxels
  std::vector<Match> matches_;     // of the selection's points
  std::size_t level_ = 0;
  float scale_m_ = 0.0F;
  int steps_along_normal_ = 0;  // voxels to each side, where a point has no correspondence
  bool is_valid_ = false;
};

}  // namespace

Registration register_sweep_from(VoxelMap& sweep_base, const VoxelMap& map, const PosePrior& prior,
                                 const SE3& T_map_start, const RegistrationParams& params) {
  return sweep_base.is_moving()
             ? SweepRegistration<12>(sweep_base, map, prior, T_map_start, params).run()
             : SweepRegistration<6>(sweep_base, map, prior, T_map_start, params).run();
}

}  // namespace nodmap::slam6d
