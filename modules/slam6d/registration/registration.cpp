// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration/registration.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "common/registration/motion_solver.hpp"
#include "common/registration/rigid_fit.hpp"
#include "common/registration/robust_kernel.hpp"
#include "modules/slam6d/registration/bend_sums.hpp"
#include "modules/slam6d/registration/correspondence_search.hpp"
#include "modules/slam6d/registration/inliers.hpp"
#include "modules/slam6d/registration/level_evidence.hpp"
#include "modules/slam6d/registration/residual_sums.hpp"
#include "modules/slam6d/registration/sweep_motion.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;
using registration::Information;

constexpr double kSettledTranslationM = 1e-4;  // a hundredth of the scanner's noise
constexpr double kSettledRotationRad = 1e-5;   // 0.1 mm at 10 m
// Scale of the robust kernel of the evidence that the wheels do not slip, in standard deviations.
constexpr double kSlipKernel = 2.0;

// Registers a sweep measured while the robot was stationary (N = 6) or moving (N = 12).
template <int N>
class SweepRegistration {
 public:
  SweepRegistration(VoxelMap& sweep, const VoxelMap& map, const PosePrior& prior,
                    const SE3& T_map_start, const RegistrationParams& params)
      : sweep_(sweep),
        map_(map),
        prior_(prior),
        params_(params),
        correspondences_(map, params.min_normal_cosine) {
    result_.T_map_base = T_map_start;
    prior_half_path_map_ = prior.T_map_base.linear() * sweep.half_path().template cast<double>();
    const Matrix covariance =
        motion_covariance<N>(prior.covariance, prior.motion_covariance, prior_half_path_map_);
    prior_information_.H = registration::inverse_definite<N>(covariance);
    prior_covariance_ = covariance.template topLeftCorner<6, 6>();
    result_.prior_end_covariance = end_covariance<N>(covariance, prior_half_path_map_);
  }

  Registration run() {
    for (std::size_t l = VoxelMap::kLevels; l-- > 0;) {
      run_level(l, kernel_scale(l, params_.coarse_residual_scale_m));
    }
    count_inliers();
    if (result_.degenerate_directions > 0 && params_.metric == ErrorMetric::kPointToPlane) {
      if (const auto reach_m =
              normal_reach_m(result_.covariance, prior_covariance_, map_.level(0).voxel_size_m())) {
        look_along_normals(*reach_m);
      }
    }
    classify();
    return result_;
  }

 private:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  // A strip of floor before a wall is too narrow for planes in coarse voxels, and too far off for
  // the finest ones. So these search for it along their normals. The result is taken if it
  // determines more directions and the sweep fits no worse.
  void look_along_normals(double reach_m) {
    const Registration before = result_;
    std::optional<VoxelMap> sweep_before;
    if constexpr (N == 12) {
      sweep_before = sweep_;
    }
    correspondences_.look_along_normals(reach_m);
    for (std::size_t l = VoxelMap::kLevels; l-- > 0;) {
      run_level(0, kernel_scale(l, std::max(reach_m, params_.coarse_residual_scale_m)));
    }
    correspondences_.look_along_normals(0.0);
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
      const Vector motion = params_.metric == ErrorMetric::kPointToPoint ? paper_step(selection)
                                                                         : plane_step(selection);
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
    if constexpr (N == 12) {
      if (level_ == 0 && params_.metric == ErrorMetric::kPointToPlane && params_.bend_rad > 0.0) {
        bend(selection);
      }
    }
    deskew();
  }

  // Ground and heading change within a sweep, so its rotation is not steady. The pose in the middle
  // of the sweep is then another than the mean one.
  void bend(const VoxelMap::Selection& selection) {
    BendSums sums;
    for_each_residual(selection, [&](const Residual& residual) {
      sums.add(residual.arm.cross(residual.normal), residual.distance_m, residual.time,
               residual.kernel * residual.precision);
    });
    const Bend bend_map = sums.solve(unit_information_, params_.bend_rad);
    const Eigen::Vector3d middle = bend_map.col(kBendKnots / 2);
    since_deskew_.bend_rad =
        result_.T_map_base.linear().transpose() * (bend_map.colwise() - middle);
    result_.T_map_base.linear() = geometry::rotation_of(middle) * result_.T_map_base.linear();
  }

  // In a sweep that was deskewed wrongly the planes are tilted, so they are computed again.
  void deskew() {
    if constexpr (N == 12) {
      sweep_.correct(since_deskew_);
      result_.correction.translation_m += since_deskew_.translation_m;
      result_.correction.rotation_rad += since_deskew_.rotation_rad;
      result_.correction.bend_rad += since_deskew_.bend_rad;
      since_deskew_ = {};
    }
  }

  // What the prior says about the motion that is still to be made.
  [[nodiscard]] Vector prior_motion() const {
    Vector motion;
    motion.template head<6>() = motion_between(result_.T_map_base, prior_.T_map_base);
    if constexpr (N == 12) {
      const Eigen::Matrix3d& R_map_base = result_.T_map_base.linear();
      // The covariance takes the first half of the path as turned by a small angle.
      const Eigen::Vector3d turned =
          R_map_base * prior_.T_map_base.linear().transpose() * prior_half_path_map_;
      motion.template head<3>() +=
          turned - prior_half_path_map_ + motion.template segment<3>(3).cross(prior_half_path_map_);
      motion.template segment<3>(6) =
          -R_map_base * (result_.correction.translation_m + since_deskew_.translation_m);
      motion.template segment<3>(9) =
          -R_map_base * (result_.correction.rotation_rad + since_deskew_.rotation_rad);
      // The prior is about the first and the last beam, where the bend counts as well.
      const Bend& bend_rad = result_.correction.bend_rad;
      const Eigen::Vector3d first = R_map_base * bend_rad.col(0);
      const Eigen::Vector3d last = R_map_base * bend_rad.col(kBendKnots - 1);
      motion.template segment<3>(3) -= 0.5 * (last + first);
      motion.template segment<3>(9) -= 0.5 * (last - first);
    }
    return motion;
  }

  // The prior with all other evidence, at the present pose. Not at coarser voxels: what is seen
  // comes first.
  [[nodiscard]] Information<N> prior_here() const {
    const Vector motion = prior_motion();
    Information<N> prior{prior_information_.H, prior_information_.H * motion};
    if (level_ > 0) {
      return prior;
    }
    if constexpr (N == 12) {
      // The robot has turned as odometry counted, unless the wheels slip. A sweep that followed the
      // map alone would take over its twist, and the map would be twisted further with each sweep.
      const auto turn = motion.template segment<3>(9);
      const double information =
          registration::robust_information(turn.norm(), params_.slip_rad, kSlipKernel);
      prior.H.template block<3, 3>(9, 9).diagonal().array() += information;
      prior.b.template segment<3>(9) += information * turn;
    }
    if (prior_.level) {
      const Information<6> level = level_evidence(*prior_.level, result_.T_map_base);
      prior.H.template topLeftCorner<6, 6>() += level.H;
      prior.b.template head<6>() += level.b;
    }
    return prior;
  }

  VoxelMap::Selection select(std::size_t l) {
    VoxelMap::Selection selection = sweep_.select(l);
    correspondences_.begin(selection.points.size());
    return selection;
  }

  // Calls `use(i, level, p_map, normal_map)` for each point of a selection.
  template <class Use>
  void for_each_point(const VoxelMap::Selection& selection, const Use& use) const {
    const Eigen::Matrix3f R = result_.T_map_base.linear().cast<float>();
    const Eigen::Vector3f t = result_.T_map_base.translation().cast<float>();
    const Eigen::Vector3f step = since_deskew_.translation_m.cast<float>();
    const Eigen::Vector3f turn = since_deskew_.rotation_rad.cast<float>();
    for (std::size_t l = 0; l < VoxelMap::kLevels; ++l) {
      for (std::size_t i = selection.first_of_level[l]; i < selection.first_of_level[l + 1]; ++i) {
        const OrientedPoint& point = selection.points[i];
        Eigen::Vector3f p_base = point.p;
        if constexpr (N == 12) {
          p_base += point.time * (step + turn.cross(point.p - point.time * sweep_.half_path()));
        }
        use(i, l, Eigen::Vector3f(R * p_base + t), Eigen::Vector3f(R * point.normal));
      }
    }
  }

  // w_ij of Eq. 3: calls `use(point, p_map, normal_map, voxel)` for each correspondence.
  template <class Use>
  void for_each_correspondence(const VoxelMap::Selection& selection, const Use& use) {
    for_each_point(selection, [&](std::size_t i, std::size_t l, const Eigen::Vector3f& p_map,
                                  const Eigen::Vector3f& normal_map) {
      if (const Voxel* voxel = correspondences_.find(i, l, p_map, normal_map)) {
        use(selection.points[i], p_map, normal_map, *voxel);
      }
    });
  }

  // The distance of a point from the plane of its correspondence.
  struct Residual {
    Eigen::Vector3f normal;
    Eigen::Vector3f arm;  // from where the base was at that time
    float distance_m = 0.0F;
    float time = 0.0F;
    float kernel = 0.0F;     // its robust weight
    float precision = 0.0F;  // inverse variance, relative to that of single points
  };

  template <class Use>
  void for_each_residual(const VoxelMap::Selection& selection, const Use& use) {
    const Eigen::Vector3f p_base = result_.T_map_base.translation().cast<float>();
    const Eigen::Vector3f half_path =
        result_.T_map_base.linear().cast<float>() * sweep_.half_path();
    const float per_sq_scale = 1.0F / (scale_m_ * scale_m_);
    for_each_correspondence(selection, [&](const OrientedPoint& point, const Eigen::Vector3f& p_map,
                                           const Eigen::Vector3f& normal_map, const Voxel& voxel) {
      const Eigen::Vector3f normal = (normal_map + voxel.normal).normalized();
      const float residual_m = normal.dot(voxel.mean - p_map);
      const float relative_sq = residual_m * residual_m * per_sq_scale;
      // Means of many points are known better, but no better than the voxels' rounding.
      const float variance = 1.0F / point.num_points + 1.0F / voxel.weight + kRoundingVariance;
      use(Residual{.normal = normal,
                   .arm = p_map - p_base - point.time * half_path,
                   .distance_m = residual_m,
                   .time = point.time,
                   .kernel = registration::geman_mcclure(relative_sq),
                   .precision = 1.0F / variance});
    });
  }

  Vector plane_step(const VoxelMap::Selection& selection) {
    ResidualSums<N> sums;
    for_each_residual(selection, [&](const Residual& residual) {
      sums.add(residual.normal, residual.arm, residual.distance_m, residual.time, residual.kernel,
               residual.precision);
    });
    sums.flush();
    result_.residual_rms_m = std::sqrt(sums.mean_square_m2());
    const double scale = unit_information_ = sums.scale(params_.residual_correlation);
    const Information<N> measurement = sums.information();
    const Matrix imitated = sums.imitated_information(params_.normal_error_rad);
    const Eigen::Vector3d half_path_map =
        result_.T_map_base.linear() * sweep_.half_path().template cast<double>();
    const Matrix turn = turned_path(half_path_map);
    const Information<N> prior = prior_here();
    const auto estimate = registration::solve_motion<N>(
        {scale * turn.transpose() * measurement.H * turn, scale * turn.transpose() * measurement.b},
        scale * turn.transpose() * imitated * turn, prior);
    result_.response =
        Matrix6d::Identity() - (estimate.covariance * prior.H).template topLeftCorner<6, 6>();
    result_.degenerate_directions = degenerate_directions(estimate.covariance);
    result_.covariance = estimate.covariance.template topLeftCorner<6, 6>();
    result_.end_covariance = end_covariance<N>(estimate.covariance, half_path_map);
    is_valid_ = estimate.is_valid;
    return estimate.x;
  }

  // From the unknowns to those of ResidualSums, whose path does not turn with the base.
  [[nodiscard]] static Matrix turned_path(const Eigen::Vector3d& half_path_map) {
    Matrix turn = Matrix::Identity();
    if constexpr (N == 12) {
      turn.template bottomLeftCorner<6, 6>() = by_rotation(half_path_map);
    }
    return turn;
  }

  // The number of directions of the pose about which the map says less than the prior.
  [[nodiscard]] int degenerate_directions(const Matrix& covariance) const {
    const Matrix6d pose = covariance.template topLeftCorner<6, 6>();
    const auto relative = registration::relative_eigenvalues(pose, prior_covariance_);
    return static_cast<int>((relative.array() > 0.5).count());
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
    is_valid_ = fit.has_value();
    result_.residual_rms_m =
        std::sqrt(sq_sum / static_cast<double>(std::max<std::size_t>(1, points.size())));
    result_.degenerate_directions = is_valid_ ? 0 : 6;
    Vector motion = Vector::Zero();
    motion.template head<6>() =
        motion_between(result_.T_map_base, fit.value_or(SE3::Identity()) * result_.T_map_base);
    return motion;
  }

  void count_inliers() {
    const InlierRatios ratios =
        slam6d::count_inliers(sweep_.select(0), correspondences_, result_.T_map_base,
                              kInlierScales * params_.fine_residual_scale_m);
    result_.inlier_ratio = ratios.all;
    result_.upright_inlier_ratio = ratios.upright;
  }

  void classify() {
    const Vector deviation = prior_motion();
    result_.prior_distance =
        std::sqrt(std::max(0.0, deviation.dot(prior_information_.H * deviation)));
    const bool is_refused = !is_valid_ ||
                            !(result_.lowest_inlier_ratio() >= params_.min_inlier_ratio) ||
                            !(result_.prior_distance <= params_.max_prior_distance);
    if (is_refused) {
      result_.state = PoseState::kLost;
      result_.T_map_base = prior_.T_map_base;
      result_.correction = {};
      result_.covariance = result_.end_covariance = prior_.covariance;
    } else {
      result_.state =
          result_.degenerate_directions > 0 ? PoseState::kDegraded : PoseState::kTracking;
    }
  }

  VoxelMap& sweep_;
  const VoxelMap& map_;
  const PosePrior& prior_;
  const RegistrationParams& params_;
  Registration result_;
  Information<N> prior_information_;
  Eigen::Vector3d prior_half_path_map_;
  Matrix6d prior_covariance_;      // of the pose in the middle of the sweep
  MotionCorrection since_deskew_;  // not yet in the sweep's voxels
  CorrespondenceSearch correspondences_;
  std::size_t level_ = 0;
  float scale_m_ = 0.0F;
  double unit_information_ = 0.0;  // of the residuals' weights
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
