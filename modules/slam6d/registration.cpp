// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/registration.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "modules/slam6d/rigid_fit.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kGateFactor = 0.8;           // from iteration to iteration
constexpr double kSettledTranslation = 1e-4;  // m: a hundredth of the scanner's noise
constexpr double kSettledRotation = 1e-5;     // rad: 0.1 mm at 10 m
constexpr double kSameSide = 0.7;  // cosine between normals: two sides of a door do not pair
// How far, a metre from the robot, the ground rises or falls on an even floor (3 degrees).
constexpr double kGroundScaleM = 0.05;
constexpr std::size_t kMinPairs = 12;  // twice the unknowns

struct Pair {
  Eigen::Vector3d p_model;
  Eigen::Vector3d p_data;  // in map, at the present pose
  Eigen::Vector3d normal;  // of the model, in map
};

// The corners of a square on the ground below the robot, paired with the ground plane on which it
// stood when it was last registered: wheels do not leave the ground. Only the guess knows of it.
std::vector<Pair> ground_pairs(const SE3& T_map_guess, const SE3& T_map_base) {
  constexpr double kReachM = 1.0;
  std::vector<Pair> pairs;
  for (const double x : {-kReachM, kReachM}) {
    for (const double y : {-kReachM, kReachM}) {
      pairs.push_back({T_map_guess.translation(), T_map_base * Eigen::Vector3d(x, y, 0.0),
                       T_map_guess.linear().col(2)});
    }
  }
  return pairs;
}

struct Step {
  SE3 T = SE3::Identity();  // in map, to be put before the present pose
  double sq_sum = 0.0;      // of the weighted distances before the step
  double weight = 0.0;
  int free_directions = 0;
  double weakest_constraint = 1.0;
};

// w_ij of Eq. 3.
std::vector<Pair> find_pairs(const Surface& surface, const Model& model, const SE3& T_map_base,
                             double gate_m, Metric metric) {
  std::vector<Pair> pairs;
  pairs.reserve(surface.points.size());
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    if (metric == Metric::kPlanes && surface.normals[i].isZero()) {
      continue;
    }
    const Eigen::Vector3d p_map = T_map_base * surface.points[i];
    const auto partner = model.nearest(p_map, gate_m);
    if (!partner) {
      continue;
    }
    if (metric == Metric::kPlanes &&
        partner->normal_map.dot(T_map_base.linear() * surface.normals[i]) < kSameSide) {
      continue;
    }
    pairs.push_back({partner->p_map, p_map, partner->normal_map});
  }
  return pairs;
}

// Eq. 3 as printed.
std::optional<Step> paper_step(const std::vector<Pair>& pairs) {
  std::vector<PointPair> points;
  points.reserve(pairs.size());
  Step step;
  for (const Pair& pair : pairs) {
    points.push_back({pair.p_model, pair.p_data});
    step.sq_sum += (pair.p_model - pair.p_data).squaredNorm();
    step.weight += 1.0;
  }
  const RigidFit fit = fit_rigid(points);
  if (fit.status != FitStatus::kOk) {
    return std::nullopt;
  }
  step.T = fit.T_model_data;
  return step;
}

// Normal equations of the weighted sum of squared distances to the planes. The motion is taken
// about the centre of the pairs and the rotation in units of their mean radius, so that the six
// directions are alike: an eigenvalue of H is the mean share with which the planes hold a
// direction.
struct PlaneSystem {
  Matrix6d H = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
  double sq_sum = 0.0;
  double weight = 0.0;

  void add(const Pair& pair, double pair_weight) {
    Vector6d J;
    J << pair.normal, (pair.p_data - centre).cross(pair.normal) / radius_m;
    H += pair_weight * J * J.transpose();
    b += pair_weight * pair.normal.dot(pair.p_model - pair.p_data) * J;
  }
};

PlaneSystem plane_system(const std::vector<Pair>& pairs, double residual_scale_m) {
  PlaneSystem system;
  for (const Pair& pair : pairs) {
    system.centre += pair.p_data / static_cast<double>(pairs.size());
  }
  double sq_radius = 0.0;
  for (const Pair& pair : pairs) {
    sq_radius += (pair.p_data - system.centre).squaredNorm() / static_cast<double>(pairs.size());
  }
  system.radius_m = std::max(std::sqrt(sq_radius), 1e-3);
  for (const Pair& pair : pairs) {
    const double residual = pair.normal.dot(pair.p_model - pair.p_data);
    const double relative = residual / residual_scale_m;
    const double weight = 1.0 / (1.0 + relative * relative);  // Cauchy
    system.add(pair, weight);
    system.sq_sum += weight * residual * residual;
    system.weight += weight;
  }
  return system;
}

std::optional<Step> plane_step(const std::vector<Pair>& pairs, const std::vector<Pair>& ground,
                               const RegistrationOptions& options) {
  PlaneSystem system = plane_system(pairs, options.residual_scale_m);
  const double all_pairs = system.weight;
  for (const Pair& pair : ground) {
    const double relative = pair.normal.dot(pair.p_model - pair.p_data) / kGroundScaleM;
    const double share = options.ground_weight / static_cast<double>(ground.size());
    system.add(pair, share * all_pairs / (1.0 + relative * relative));
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(system.H);
  Step step{.sq_sum = system.sq_sum, .weight = system.weight};
  step.weakest_constraint = std::max(0.0, eigen.eigenvalues()[0] / system.weight);
  Vector6d x = Vector6d::Zero();
  for (int i = 0; i < 6; ++i) {
    const Vector6d direction = eigen.eigenvectors().col(i);
    if (eigen.eigenvalues()[i] > options.min_constraint * system.weight) {
      x += direction * (direction.dot(system.b) / eigen.eigenvalues()[i]);
    } else {
      ++step.free_directions;
    }
  }
  if (step.free_directions == 6 || !x.allFinite()) {
    return std::nullopt;
  }
  const Eigen::Vector3d turn = x.tail<3>() / system.radius_m;
  const double angle = turn.norm();
  if (angle > 0.0) {
    step.T.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  }
  step.T.translation() = system.centre + x.head<3>() - step.T.linear() * system.centre;
  return step;
}

bool is_settled(const SE3& before, const SE3& after) {
  const SE3 moved = before.inverse() * after;
  return moved.translation().norm() < kSettledTranslation &&
         geometry::rotation_angle(moved) < kSettledRotation;
}

}  // namespace

Registration register_surface(const Surface& surface_base, const Model& model,
                              const SE3& T_map_base_guess, const RegistrationOptions& options) {
  Registration result{.T_map_base = T_map_base_guess};
  const auto num_points = static_cast<double>(surface_base.points.size());
  const auto give_up = [&](RegistrationStatus why) {
    result.status = why;
    result.T_map_base = T_map_base_guess;
    return result;
  };
  double gate_m = options.max_correspondence_m;
  while (result.iterations < options.iterations) {
    ++result.iterations;
    const std::vector<Pair> pairs =
        find_pairs(surface_base, model, result.T_map_base, gate_m, options.metric);
    result.match_share = num_points > 0.0 ? static_cast<double>(pairs.size()) / num_points : 0.0;
    if (pairs.size() < kMinPairs || result.match_share < options.min_match_share) {
      return give_up(RegistrationStatus::kTooFewPairs);
    }
    // On a new slope the guess is right about nothing but the place: the pairs go first.
    const bool is_near = gate_m <= options.min_correspondence_m;
    const std::vector<Pair> ground =
        is_near ? ground_pairs(T_map_base_guess, result.T_map_base) : std::vector<Pair>();
    const std::optional<Step> step =
        options.metric == Metric::kPaper ? paper_step(pairs) : plane_step(pairs, ground, options);
    if (!step) {
      return give_up(RegistrationStatus::kDegenerate);
    }
    result.match_rms_m = std::sqrt(step->sq_sum / step->weight);
    result.free_directions = step->free_directions;
    result.weakest_constraint = step->weakest_constraint;
    const SE3 T_before = result.T_map_base;
    result.T_map_base = step->T * T_before;
    if (gate_m <= options.min_correspondence_m && is_settled(T_before, result.T_map_base)) {
      result.status = RegistrationStatus::kConverged;
      return result;
    }
    gate_m = std::max(options.min_correspondence_m, kGateFactor * gate_m);
  }
  result.status = RegistrationStatus::kNotConverged;
  return result;
}

}  // namespace nodmap::slam6d
