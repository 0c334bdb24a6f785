// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/loop_closer.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "common/geometry/pose_tolerance.hpp"

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// Within this, registration converges without a search.
constexpr double kReachM = 0.3;
constexpr double kReachRad = geometry::deg_to_rad(6.0);
// Steps of the search, and the level of voxels that it uses: those of 40 cm.
constexpr double kStepM = 0.4;
constexpr double kStepRad = geometry::deg_to_rad(6.0);
constexpr std::size_t kSearchLevel = 2;
constexpr std::size_t kMaxSearchPoints = 300;
// Two maps of one place differ by at least this, however well they match.
constexpr double kLoopSigmaM = 0.003;
constexpr double kLoopSigmaRad = geometry::deg_to_rad(0.03);
constexpr std::size_t kMaxPendingAge = 15;  // keyframes

struct Reach {
  double distance_m;
  double heading_rad;
};

Reach reach_of(const PosePrior& prior) {
  const auto variance = prior.covariance.diagonal();
  return {kReachSigmas * std::sqrt(std::max(variance[0], variance[1])),
          kReachSigmas * std::sqrt(variance[5])};
}

int num_steps(double length, double step) {
  return static_cast<int>(std::ceil(length / step));
}

// How many points have a correspondence in the voxels of the place.
double num_correspondences(std::span<const OrientedPoint> points, const SE3& T_place_base,
                           const VoxelGrid& place, float min_normal_cosine) {
  const Eigen::Matrix3f R = T_place_base.linear().cast<float>();
  const Eigen::Vector3f t = T_place_base.translation().cast<float>();
  const auto max_m = static_cast<float>(place.voxel_size_m());
  return static_cast<double>(std::ranges::count_if(points, [&](const OrientedPoint& point) {
    const std::uint32_t nearest = place.nearest(R * point.p + t, max_m);
    return nearest != VoxelGrid::kNone &&
           (R * point.normal).dot(place.voxels()[nearest].normal) >= min_normal_cosine;
  }));
}

// The information of a match alone: without its prior, and limited by how well two maps of one
// place agree.
Matrix6d information_of_match(const Registration& found, const PosePrior& prior) {
  const Matrix6d difference =
      registration::inverse(found.covariance) - registration::inverse(prior.covariance);
  const auto [values, vectors] =
      registration::eigensystem(Matrix6d(0.5 * (difference + difference.transpose())));
  const Matrix6d information = vectors * values.cwiseMax(0.0).asDiagonal() * vectors.transpose();
  Matrix6d floor = Matrix6d::Zero();
  floor.diagonal() << Eigen::Vector3d::Constant(kLoopSigmaM * kLoopSigmaM),
      Eigen::Vector3d::Constant(kLoopSigmaRad * kLoopSigmaRad);
  const Matrix6d bounded =
      registration::solve(Matrix6d::Identity() + information * floor, information);
  return 0.5 * (bounded + bounded.transpose());
}

}  // namespace

LoopCloser::LoopCloser(const LoopParams& params, const RegistrationParams& registration)
    : params_(params), registration_(registration) {}

bool LoopCloser::needs_search(const PosePrior& prior) {
  const Reach reach = reach_of(prior);
  return reach.distance_m > kReachM || reach.heading_rad > kReachRad;
}

LoopAttempt LoopCloser::match(VoxelMap& keyframe, const VoxelMap& place,
                              const PosePrior& prior) const {
  return needs_search(prior)
             ? search(keyframe, place, prior)
             : attempt(register_sweep_from(keyframe, place, prior, prior.T_map_base, registration_),
                       prior);
}

LoopAttempt LoopCloser::attempt(const Registration& found, const PosePrior& prior) const {
  if (!found.is_accepted() || found.lowest_inlier_ratio() < params_.match.min_inlier_ratio) {
    return {};
  }
  return {.loop = Loop{.T_from_to = found.T_map_base,
                       .information = information_of_match(found, prior)}};
}

LoopAttempt LoopCloser::search(VoxelMap& keyframe, const VoxelMap& place,
                               const PosePrior& prior) const {
  const StartsResult result = register_from(
      starts(keyframe, place, prior), keyframe, place,
      [&prior](const SE3& /*T_map_start*/) { return prior; },
      [](const SE3& /*T_map_base*/) { return true; }, registration_);
  if (!result.best) {
    return {.refusal = result.is_ambiguous ? LoopRefusal::kAmbiguous : LoopRefusal::kLowScore};
  }
  return attempt(*result.best, prior);
}

// Scores all poses within reach, each from the prior rotated about its z axis and moved in the
// plane. Height, roll and pitch are the prior's; registration corrects them.
std::vector<StartPose> LoopCloser::starts(const VoxelMap& keyframe, const VoxelMap& place,
                                          const PosePrior& prior) const {
  const Reach reach = reach_of(prior);
  const int steps_m = num_steps(std::min(reach.distance_m, params_.search.max_distance_m), kStepM);
  const int steps_rad =
      num_steps(std::min(reach.heading_rad, params_.search.max_rotation_rad), kStepRad);
  const std::vector<OrientedPoint> points =
      some_of(keyframe.select(kSearchLevel).points, kMaxSearchPoints);
  const VoxelGrid& grid = place.level(kSearchLevel);
  const auto min_cosine = static_cast<float>(registration_.min_normal_cosine);
  const Eigen::Vector3d up = prior.T_map_base.linear().col(2);
  std::vector<StartPose> tried;
  for (int h = -steps_rad; h <= steps_rad; ++h) {
    SE3 T = prior.T_map_base;
    T.linear() = geometry::rotation_of(h * kStepRad * up) * T.linear();
    for (int x = -steps_m; x <= steps_m; ++x) {
      for (int y = -steps_m; y <= steps_m; ++y) {
        T.translation() = prior.T_map_base.translation() + Eigen::Vector3d(x, y, 0.0) * kStepM;
        tried.push_back({T, num_correspondences(points, T, grid, min_cosine)});
      }
    }
  }
  return best_starts(std::move(tried));
}

std::vector<Loop> LoopCloser::add_pending(const Loop& loop, std::span<const SE3> T_map_keyframes) {
  pending_.push_back(loop);
  std::erase_if(pending_, [&](const Loop& old) { return old.to + kMaxPendingAge < loop.to; });
  const SE3& T_map_last = T_map_keyframes[loop.to];
  // The pose of the newest keyframe in map according to a loop.
  const auto consequence = [&](const Loop& other) -> SE3 {
    return T_map_keyframes[other.from] * other.T_from_to *
           (T_map_keyframes[other.to].inverse() * T_map_last);
  };
  std::vector<Loop> consensus;
  std::set<std::size_t> keyframes;
  const SE3 here = consequence(loop);
  for (const Loop& other : pending_) {
    const double between_m = geometry::distance_m(T_map_keyframes[other.to], T_map_last);
    if (geometry::is_within(here, consequence(other),
                            {.distance_m = params_.consensus.max_distance_m + 0.02 * between_m,
                             .rotation_rad = params_.consensus.max_rotation_rad})) {
      consensus.push_back(other);
      keyframes.insert(other.to);
    }
  }
  if (keyframes.size() < static_cast<std::size_t>(params_.consensus.min_keyframes)) {
    return {};
  }
  pending_.clear();
  return consensus;
}

void LoopCloser::drop_keyframe(const ReplacedKeyframe& replaced) {
  std::erase_if(pending_, [&replaced](const Loop& loop) {
    return loop.from == replaced.index || loop.to == replaced.index;
  });
  for (Loop& loop : pending_) {
    loop.from = replaced.renumbered(loop.from);
    loop.to = replaced.renumbered(loop.to);
  }
}

}  // namespace nodmap::slam6d
