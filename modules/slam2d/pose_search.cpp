// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/pose_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "modules/slam2d/score_bound.hpp"

namespace nodmap::slam2d {
namespace {

constexpr double kStepM = 0.25;  // ICP converges from half of it
constexpr int kStepCells = static_cast<int>(kStepM / ScoreBound::kCellM);
constexpr double kMaxStepRad = geometry::deg_to_rad(4.0);
constexpr double kMaxDistanceM = 0.25;  // a point this far from the map scores 0
constexpr std::size_t kNumPoints = 90;  // enough to rank poses; 45 misplace a rotation of mit-csail
constexpr std::size_t kMaxCandidates = 10;
constexpr double kDistinctM = 0.4;
constexpr double kDistinctRad = 0.1;
// Cost, in units of score, of a rotation of 90 degrees or of twice the search distance: of two
// poses with the same score the one nearer to odometry is more likely. People around the robot
// halve the score at the true pose; with a cost of 0.1 poses would then be found anywhere.
constexpr double kDeviationCost = 0.25;

// Rounding of the bounds of scores.
constexpr double kRounding = 1e-9;

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
  return std::min(kMaxStepRad, std::numbers::sqrt2 * kStepM / std::max(distance_m, kStepM));
}

// Mean over the points: 1 on a map point, 0 from `kMaxDistanceM` on.
double quick_score(const PointMap& map, std::span<const OrientedPoint> scan,
                   const geometry::SE2& T_target_base) {
  const Eigen::Matrix2d R = T_target_base.rotation();
  const Eigen::Vector2d t = T_target_base.translation();
  double sum = 0.0;
  for (const auto& [p, normal] : scan) {
    const OrientedPoint point{R * p + t, R * normal};
    if (const MapPoint* found = map.nearest(point, kMaxDistanceM)) {
      sum += 1.0 - (found->point.p - point.p).norm() / kMaxDistanceM;
    }
  }
  return scan.empty() ? 0.0 : sum / static_cast<double>(scan.size());
}

bool are_distinct(const geometry::SE2& a, const geometry::SE2& b) {
  return std::hypot(a.x - b.x, a.y - b.y) >= kDistinctM ||
         std::abs(geometry::angle_difference(a.yaw, b.yaw)) >= kDistinctRad;
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
    const double distance_m = std::hypot(pose.x - guess.x, pose.y - guess.y);
    const double rotation_rad = std::abs(geometry::angle_difference(pose.yaw, guess.yaw));
    least = std::min(least, rotation_rad / (0.5 * geometry::kPi) +
                                distance_m / std::max(2.0 * params_.distance_m, kStepM));
  }
  return kDeviationCost * least;
}

std::vector<PoseSearch::Candidate> PoseSearch::poses_around(
    const PointMap& map, std::span<const OrientedPoint> scan,
    std::span<const geometry::SE2> guesses) const {
  const geometry::SE2& guess = guesses.front();
  const int steps = static_cast<int>(params_.distance_m / kStepM);
  const double step_rad = rotation_step_rad(scan);
  const int rotations = static_cast<int>(params_.rotation_rad / step_rad);
  const ScoreBound bound(map, guess.translation(), kMaxDistanceM, kStepCells * steps);
  std::vector<Candidate> poses;
  std::vector<Eigen::Vector2d> points;
  for (int iyaw = -rotations; iyaw <= rotations; ++iyaw) {
    const geometry::SE2 rotated{guess.x, guess.y,
                                geometry::normalize_angle(guess.yaw + iyaw * step_rad)};
    const Eigen::Matrix2d R = rotated.rotation();
    points.clear();
    for (const OrientedPoint& point : scan) {
      points.emplace_back(R * point.p + rotated.translation());
    }
    const std::vector<std::size_t> cells = bound.cells_of(points);
    for (int ix = -steps; ix <= steps; ++ix) {
      for (int iy = -steps; iy <= steps; ++iy) {
        const geometry::SE2 pose{guess.x + ix * kStepM, guess.y + iy * kStepM, rotated.yaw};
        const double cost = this->cost(pose, guesses);
        poses.push_back(
            {.score = bound.at(cells, kStepCells * ix, kStepCells * iy) + kRounding - cost,
             .cost = cost,
             .order = poses.size(),
             .is_bound = true,
             .T_target_base = pose});
      }
    }
  }
  return poses;
}

// Lazy evaluation: a queue holds all poses, the most promising first, at first with upper bounds of
// their scores. A pose is scored only when it comes first; most never are.
std::vector<geometry::SE2> PoseSearch::candidates(const PointMap& map,
                                                  std::span<const OrientedPoint> scan,
                                                  std::span<const geometry::SE2> guesses) const {
  const std::vector<OrientedPoint> some = points_to_score(scan);
  const auto is_worse = [](const Candidate& a, const Candidate& b) {
    return a.score != b.score ? a.score < b.score : a.order > b.order;
  };
  std::vector<Candidate> queue = poses_around(map, some, guesses);
  std::make_heap(queue.begin(), queue.end(), is_worse);
  std::vector<geometry::SE2> best;
  while (!queue.empty() && best.size() < kMaxCandidates) {
    std::pop_heap(queue.begin(), queue.end(), is_worse);
    Candidate& candidate = queue.back();
    const bool is_new = std::all_of(best.begin(), best.end(), [&](const geometry::SE2& other) {
      return are_distinct(candidate.T_target_base, other);
    });
    if (is_new && candidate.is_bound) {
      candidate.score = quick_score(map, some, candidate.T_target_base) - candidate.cost;
      candidate.is_bound = false;
      std::push_heap(queue.begin(), queue.end(), is_worse);
      continue;
    }
    if (is_new) {
      best.push_back(candidate.T_target_base);
    }
    queue.pop_back();
  }
  return best;
}

}  // namespace nodmap::slam2d
