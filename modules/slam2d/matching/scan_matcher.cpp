// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/matching/scan_matcher.hpp"

#include <algorithm>
#include <cmath>

#include "common/registration/rigid_fit_2d.hpp"
#include "common/registration/robust_kernel.hpp"

namespace nodmap::slam2d {
namespace {

constexpr int kMinCorrespondences = 10;

// Scale of the weights as a ratio of the maximum correspondence distance. Between 0.5 (loops with
// some drift are missed) and 0.9 (points of other walls attract) the errors on all recordings
// change by less than 10 %.
constexpr double kKernelScaleRatio = 0.7;

// The maximum correspondence distance shrinks by this factor once a step is shorter than this part
// of it.
constexpr double kDistanceDecay = 0.6;
constexpr double kStageDoneRatio = 0.1;

// A map point without a line (a corner, foliage) constrains both directions, but less surely.
constexpr double kNoLineWeight = 0.3;

// Variance of the distance of a scan point from the map. The errors of neighbouring points are
// correlated (a wall that is not straight, an error of the map): ten points count as one.
constexpr double kPointVarianceM2 = 10.0 * 0.02 * 0.02;

constexpr double kConvergedM = 5e-4;
constexpr double kConvergedRad = 1e-4;

// The weight w_ij of a correspondence.
class Kernel {
 public:
  explicit Kernel(double scale_m) : per_m2_(1.0 / (scale_m * scale_m)) {}
  [[nodiscard]] double operator()(double squared_m2) const {
    return registration::geman_mcclure(per_m2_ * squared_m2);
  }

 private:
  double per_m2_;
};

}  // namespace

// Sums over all correspondences of a scan at one pose.
struct ScanMatcher::Correspondences {
  explicit Correspondences(const Eigen::Vector2d& reference) : points(reference) {}

  registration::RigidFit2d points;      // Eq. 3 between points
  registration::NormalEquations lines;  // Eq. 3 between points and lines
  int count = 0;
  double score_sum = 0.0;
  double weight = 0.0;
  double squared_m2 = 0.0;  // weighted
};

ScanMatcher::Correspondences ScanMatcher::find_correspondences(const PointMap& map,
                                                               std::span<const OrientedPoint> scan,
                                                               const geometry::SE2& T_target_base,
                                                               double max_distance_m,
                                                               Remembered& remembered) const {
  const bool fits_points = !uses_lines(max_distance_m);
  const Kernel kernel(kKernelScaleRatio * max_distance_m);
  const Eigen::Matrix2d R = T_target_base.rotation();
  const Eigen::Vector2d t = T_target_base.translation();
  Correspondences sums(t);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector2d moment_arm = R * scan[i].p;
    const OrientedPoint data{moment_arm + t, R * scan[i].normal};
    const MapPoint* model =
        map.nearest(data, max_distance_m, remembered.around[i], remembered.block);
    if (model == nullptr) {
      continue;
    }
    ++sums.count;
    const Eigen::Vector2d offset = data.p - model->point.p;
    if (model->has_line()) {
      const double distance_m = model->line_normal.dot(data.p - model->line_point);
      const double weight = kernel(distance_m * distance_m);
      if (fits_points) {
        sums.points.add(model->point.p, data.p, kernel(offset.squaredNorm()));
      }
      sums.lines.add(model->line_normal, moment_arm, distance_m, weight);
      sums.score_sum += weight;
      sums.weight += weight;
      sums.squared_m2 += weight * distance_m * distance_m;
      continue;
    }
    const double point_weight = kernel(offset.squaredNorm());
    if (!data.has_normal() || !model->point.has_normal()) {
      // Isolated points count for the score, but not for the pose: at the far ends of a corridor's
      // walls they move with the robot, and would hold the pose back.
      sums.score_sum += point_weight;
    } else {
      const double weight = kNoLineWeight * point_weight;
      if (fits_points) {
        sums.points.add(model->point.p, data.p, weight);
      }
      sums.lines.add(Eigen::Vector2d::UnitX(), moment_arm, offset.x(), weight);
      sums.lines.add(Eigen::Vector2d::UnitY(), moment_arm, offset.y(), weight);
      sums.score_sum += point_weight;
      sums.weight += 2.0 * weight;
      sums.squared_m2 += weight * offset.squaredNorm();
    }
  }
  return sums;
}

bool ScanMatcher::uses_lines(double max_distance_m) const {
  return params_.metric == ErrorMetric::kPointToLine &&
         max_distance_m <= params_.min_correspondence_distance_m;
}

double ScanMatcher::last_distance_m() const {
  return params_.metric == ErrorMetric::kPointToLine
             ? std::min(params_.min_line_distance_m, params_.min_correspondence_distance_m)
             : params_.min_correspondence_distance_m;
}

// (dx, dy in metres, dyaw in radians) in map, without what degenerate directions add.
Eigen::Vector3d ScanMatcher::step(const Correspondences& correspondences,
                                  const registration::NormalEquations::Solution& lines,
                                  const geometry::SE2& T_target_base, double max_distance_m) const {
  if (uses_lines(max_distance_m)) {
    return lines.step;
  }
  const geometry::SE2 fit = correspondences.points.solve().value_or(geometry::SE2{});
  const geometry::SE2 T_next = fit * T_target_base;
  const Eigen::Vector3d step(T_next.x - T_target_base.x, T_next.y - T_target_base.y, fit.yaw);
  return lines.projector * step;
}

Match ScanMatcher::match(const PointMap& map, std::span<const OrientedPoint> scan,
                         const geometry::SE2& T_target_base_guess) const {
  Match match;
  match.T_target_base = T_target_base_guess;
  const double last_distance_m = this->last_distance_m();
  double max_distance_m = std::max(params_.max_correspondence_distance_m, last_distance_m);
  Remembered remembered{.around = std::vector<Neighbourhood>(scan.size()), .block = {}};
  while (match.iterations < params_.max_iterations) {
    ++match.iterations;
    // w_ij of Eq. 3.
    const Correspondences correspondences =
        find_correspondences(map, scan, match.T_target_base, max_distance_m, remembered);
    if (correspondences.count < kMinCorrespondences) {
      match.T_target_base = T_target_base_guess;
      match.degenerate_directions = 3;
      return match;
    }
    const auto lines = correspondences.lines.solve(params_.min_information_ratio);
    match.degenerate_directions = lines.degenerate_directions;
    // The minimum of Eq. 3 for these correspondences.
    const Eigen::Vector3d step =
        this->step(correspondences, lines, match.T_target_base, max_distance_m);
    match.T_target_base = {match.T_target_base.x + step.x(), match.T_target_base.y + step.y(),
                           geometry::normalize_angle(match.T_target_base.yaw + step.z())};
    const double translation_m = step.head<2>().norm();
    const double rotation_rad = std::abs(step.z());
    if (max_distance_m <= last_distance_m && translation_m < kConvergedM &&
        rotation_rad < kConvergedRad) {
      break;
    }
    if (std::max(translation_m, rotation_rad) < kStageDoneRatio * max_distance_m) {
      max_distance_m = std::max(last_distance_m, kDistanceDecay * max_distance_m);
    }
  }
  evaluate(map, scan, remembered, match);
  return match;
}

// Uses d_max of the points: that of the lines is too narrow to tell a scan that is slightly off
// from one that is lost.
void ScanMatcher::evaluate(const PointMap& map, std::span<const OrientedPoint> scan,
                           Remembered& remembered, Match& match) const {
  const Correspondences correspondences = find_correspondences(
      map, scan, match.T_target_base, params_.min_correspondence_distance_m, remembered);
  const auto num_points = static_cast<double>(scan.size());
  match.inlier_ratio = correspondences.count / num_points;
  match.score = correspondences.score_sum / num_points;
  const auto lines = correspondences.lines.solve(params_.min_information_ratio);
  match.information = correspondences.lines.information(lines) / kPointVarianceM2;
  match.least_information_ratio = lines.least_information_ratio;
  match.rms_m = correspondences.weight > 0.0
                    ? std::sqrt(correspondences.squared_m2 / correspondences.weight)
                    : 0.0;
}

}  // namespace nodmap::slam2d
