// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/line_adjustment.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <cstddef>

#include "common/geometry/angle.hpp"
#include "common/registration/pose_edges.hpp"
#include "common/registration/robust_kernel.hpp"
#include "modules/slam2d/matching/point_map.hpp"

namespace nodmap::slam2d {
namespace {

using registration::moment_arm_jacobian;

constexpr int kMaxAdjustments = 10;
constexpr double kStillM = 1e-4;
constexpr double kStillRad = 1e-5;

// As in a match: a point belongs to the line of the nearest map point, and loses its weight with
// the distance from that line.
constexpr double kLineReachM = 0.25;
constexpr double kKernelScaleM = 0.056;

// A range errs along its beam, by 1 cm: far along a wall, where the beam grazes it, this is only
// millimetres across. There walls are not straight, and beams not exactly where they should be, by
// 5 mm. Ten points count as one, because such errors are correlated.
constexpr double kRangeSigmaM = 0.01;
constexpr double kLineSigmaM = 0.005;
constexpr double kPointsPerIndependent = 10.0;

// The present steps are right to a centimetre. This holds the poses where lines tell nothing: along
// a corridor, the noise in the direction of short lines would move them by centimetres.
constexpr double kStepSigmaM = 0.01;
constexpr double kStepSigmaRatio = 0.02;
constexpr double kStepSigmaRad = 0.02;

// What one keyframe measured of the line through a map point. The sums are weighted.
struct Sighting {
  std::size_t keyframe = 0;
  double weight = 0.0;
  double distance_m = 0.0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  // of the distance, by the pose
};

// The normal equations of a motion (x, y in m, yaw in rad, in the axes of map) of each pose.
class Equations {
 public:
  explicit Equations(std::size_t num_poses)
      : hessian_(Eigen::MatrixXd::Zero(at(num_poses), at(num_poses))),
        gradient_(Eigen::VectorXd::Zero(at(num_poses))) {}

  void add(std::size_t row, std::size_t column, const Eigen::Matrix3d& block) {
    hessian_.block<3, 3>(at(row), at(column)) += block;
  }
  void add(std::size_t row, const Eigen::Vector3d& gradient) {
    gradient_.segment<3>(at(row)) += gradient;
  }
  void add_line(const std::vector<Sighting>& sightings);

  // The first pose does not move.
  [[nodiscard]] Eigen::VectorXd solve() const {
    const Eigen::Index free = gradient_.size() - 3;
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(gradient_.size());
    motion.tail(free) = -hessian_.bottomRightCorner(free, free).ldlt().solve(gradient_.tail(free));
    return motion;
  }

 private:
  static Eigen::Index at(std::size_t pose) { return 3 * static_cast<Eigen::Index>(pose); }

  Eigen::MatrixXd hessian_;
  Eigen::VectorXd gradient_;
};

// The line lies where it fits all sightings best, and is eliminated: what is left tells how the
// sightings differ.
void Equations::add_line(const std::vector<Sighting>& sightings) {
  double weight = 0.0;
  double distance_m = 0.0;
  for (const Sighting& sighting : sightings) {
    weight += sighting.weight;
    distance_m += sighting.distance_m;
  }
  if (!(weight > 0.0)) {
    return;
  }
  for (const Sighting& a : sightings) {
    add(a.keyframe, -a.gradient * (distance_m / weight));
    for (const Sighting& b : sightings) {
      add(a.keyframe, b.keyframe, -a.gradient * b.gradient.transpose() / weight);
    }
  }
}

double weight_of(const MapPoint& line, const Eigen::Vector2d& beam, double distance_m) {
  const double relative = distance_m / kKernelScaleM;
  const double across_m = kRangeSigmaM * line.line_normal.dot(beam.normalized());
  const double variance_m2 = across_m * across_m + kLineSigmaM * kLineSigmaM;
  return registration::geman_mcclure(relative * relative) / (kPointsPerIndependent * variance_m2);
}

void add_lines(std::span<const Keyframe> keyframes, std::span<const geometry::SE2> poses,
               const MapParams& map_params, Equations& equations) {
  PointMap map(map_params);
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    map.insert(transformed(poses[k], oriented_points(keyframes[k])));
  }
  std::vector<std::vector<Sighting>> sightings(map.points().size());
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    for (const OrientedPoint& point : transformed(poses[k], oriented_points(keyframes[k]))) {
      const MapPoint* const line = map.nearest(point, kLineReachM);
      if (line == nullptr || !line->has_line()) {
        continue;
      }
      const double distance_m = line->line_normal.dot(point.p - line->line_point);
      const Eigen::Vector2d beam = point.p - poses[k] * keyframes[k].sensor_origin_base;
      const double weight = weight_of(*line, beam, distance_m);
      const Eigen::Vector3d gradient =
          moment_arm_jacobian(point.p - poses[k].translation()).topRows<2>().transpose() *
          line->line_normal;
      equations.add(k, k, weight * gradient * gradient.transpose());
      equations.add(k, weight * distance_m * gradient);
      std::vector<Sighting>& of_line =
          sightings[static_cast<std::size_t>(line - map.points().data())];
      if (of_line.empty() || of_line.back().keyframe != k) {
        of_line.push_back({.keyframe = k});
      }
      of_line.back().weight += weight;
      of_line.back().distance_m += weight * distance_m;
      of_line.back().gradient += weight * gradient;
    }
  }
  for (const std::vector<Sighting>& of_line : sightings) {
    equations.add_line(of_line);
  }
}

void add_steps(std::span<const Keyframe> keyframes, std::span<const geometry::SE2> poses,
               Equations& equations) {
  for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
    const geometry::SE2 step = keyframes[k].T_map_base.inverse() * keyframes[k + 1].T_map_base;
    const double sigma_m = kStepSigmaM + kStepSigmaRatio * std::hypot(step.x, step.y);
    // The same along x and y, therefore also in the axes of map.
    const Eigen::Matrix3d information =
        Eigen::Vector3d(sigma_m, sigma_m, kStepSigmaRad).cwiseAbs2().cwiseInverse().asDiagonal();
    const geometry::SE2 expected = poses[k] * step;
    Eigen::Vector3d error;
    error << poses[k + 1].translation() - expected.translation(),
        geometry::normalize_angle(poses[k + 1].yaw - expected.yaw);
    const Eigen::Matrix3d J = -moment_arm_jacobian(expected.translation() - poses[k].translation());
    equations.add(k, k, J.transpose() * information * J);
    equations.add(k, k + 1, J.transpose() * information);
    equations.add(k + 1, k, information * J);
    equations.add(k + 1, k + 1, information);
    equations.add(k, J.transpose() * information * error);
    equations.add(k + 1, information * error);
  }
}

// Returns whether no pose has moved by more than the limits of convergence.
bool move(std::vector<geometry::SE2>& poses, const Eigen::VectorXd& motion) {
  bool has_converged = true;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Eigen::Vector3d d = motion.segment<3>(3 * static_cast<Eigen::Index>(k));
    poses[k] = {poses[k].x + d.x(), poses[k].y + d.y(),
                geometry::normalize_angle(poses[k].yaw + d.z())};
    has_converged &= d.head<2>().norm() < kStillM && std::abs(d.z()) < kStillRad;
  }
  return has_converged;
}

}  // namespace

std::vector<geometry::SE2> adjusted_to_lines(std::span<const Keyframe> keyframes,
                                             const MapParams& map_params) {
  std::vector<geometry::SE2> poses;
  for (const Keyframe& keyframe : keyframes) {
    poses.push_back(keyframe.T_map_base);
  }
  bool has_converged = poses.size() < 2;
  for (int i = 0; i < kMaxAdjustments && !has_converged; ++i) {
    Equations equations(poses.size());
    add_lines(keyframes, poses, map_params, equations);
    add_steps(keyframes, poses, equations);
    const Eigen::VectorXd motion = equations.solve();
    if (!motion.allFinite()) {
      break;
    }
    has_converged = move(poses, motion);
  }
  return poses;
}

}  // namespace nodmap::slam2d
