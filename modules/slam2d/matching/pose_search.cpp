// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/matching/pose_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/geometry/pose_tolerance.hpp"
#include "common/geometry/whole_steps.hpp"
#include "modules/slam2d/matching/lattice_scores.hpp"

namespace nodmap::slam2d {
namespace {

constexpr double kLatticeStepM = LatticeScores::kStepM;  // ICP converges from half of it
constexpr double kMaxStepRad = geometry::deg_to_rad(4.0);
constexpr std::size_t kNumPoints = 90;  // enough to rank poses; 45 misplace a rotation of mit-csail
constexpr std::size_t kMaxCandidates = 10;
constexpr geometry::PoseTolerance kSamePose{.distance_m = 0.4, .rotation_rad = 0.1};
// Cost, in units of score, of a rotation of 90 degrees or of twice the search distance: of two
// poses with the same score the one nearer to odometry is more likely. People around the robot
// halve the score at the true pose; with a cost of 0.1 poses would then be found anywhere.
constexpr double kDeviationCost = 0.25;

// A part of the points, spread over the scan.
std::vector<OrientedPoint> points_to_score(std::span<const OrientedPoint> scan) {
  const std::size_t stride = std::max<std::size_t>(1, scan.size() / kNumPoints);
  std::vector<OrientedPoint> some;
  for (std::size_t i = 0; i < scan.size(); i += stride) {
    some.push_back(scan[i]);
  }
  return some;
}

// The step between start poses in rotation. It moves the points, at their root mean square distance
// from the robot, as far as two poses diagonally next to each other are apart: in the open, four
// degrees would move them beyond the reach of a match.
double rotation_step_rad(std::span<const OrientedPoint> scan) {
  double sum_m2 = 0.0;
  for (const OrientedPoint& point : scan) {
    sum_m2 += point.p.squaredNorm();
  }
  const double distance_m = std::sqrt(sum_m2 / std::max(1.0, static_cast<double>(scan.size())));
  return std::min(kMaxStepRad,
                  std::numbers::sqrt2 * kLatticeStepM / std::max(distance_m, kLatticeStepM));
}

}  // namespace

std::optional<Match> PoseSearch::find_better(const ScanMatcher& matcher, const PointMap& map,
                                             std::span<const OrientedPoint> scan,
                                             std::span<const geometry::SE2> guesses,
                                             const Match& tracked) const {
  std::optional<Match> best;
  double best_value = tracked.score + params_.min_gain;
  for (const geometry::SE2& start : candidates(map, scan, guesses)) {
    const Match match = matcher.match(map, scan, start);
    const double value = match.score - cost(match.T_target_base, guesses);
    // Along a degenerate direction the match could be anywhere: no better than odometry.
    if (match.degenerate_directions == 0 && value > best_value) {
      best_value = value;
      best = match;
    }
  }
  return best;
}

double PoseSearch::cost(const geometry::SE2& pose, std::span<const geometry::SE2> guesses) const {
  double least = std::numeric_limits<double>::infinity();
  for (const geometry::SE2& guess : guesses) {
    least = std::min(least, geometry::rotation_rad(pose, guess) / (0.5 * geometry::kPi) +
                                geometry::distance_m(pose, guess) /
                                    std::max(2.0 * params_.distance_m, kLatticeStepM));
  }
  return kDeviationCost * least;
}

std::vector<PoseSearch::Candidate> PoseSearch::poses_around(
    const PointMap& map, std::span<const OrientedPoint> scan,
    std::span<const geometry::SE2> guesses) const {
  const geometry::SE2& guess = guesses.front();
  const int steps = geometry::whole_steps(params_.distance_m, kLatticeStepM);
  const double step_rad = rotation_step_rad(scan);
  const int rotations = static_cast<int>(params_.rotation_rad / step_rad);
  LatticeScores scores(map, guess.translation(), steps);
  std::vector<Candidate> poses;
  for (int iyaw = -rotations; iyaw <= rotations; ++iyaw) {
    const double yaw_rad = geometry::normalize_angle(guess.yaw + iyaw * step_rad);
    scores.compute(scan, yaw_rad);
    for (int ix = -steps; ix <= steps; ++ix) {
      for (int iy = -steps; iy <= steps; ++iy) {
        const Eigen::Vector2d p_map = scores.position(ix, iy);
        const geometry::SE2 pose{p_map.x(), p_map.y(), yaw_rad};
        poses.push_back({scores.at(ix, iy) - cost(pose, guesses), pose});
      }
    }
  }
  return poses;
}

std::vector<geometry::SE2> PoseSearch::candidates(const PointMap& map,
                                                  std::span<const OrientedPoint> scan,
                                                  std::span<const geometry::SE2> guesses) const {
  std::vector<Candidate> poses = poses_around(map, points_to_score(scan), guesses);
  std::vector<geometry::SE2> best;
  while (!poses.empty() && best.size() < kMaxCandidates) {
    // The first of those with the same score.
    const geometry::SE2 next =
        std::ranges::max_element(poses, {}, &Candidate::score)->T_target_base;
    best.push_back(next);
    std::erase_if(poses, [&](const Candidate& candidate) {
      return geometry::is_within(candidate.T_target_base, next, kSamePose);
    });
  }
  return best;
}

}  // namespace nodmap::slam2d
