// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/pose_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nodmap::slam2d {
namespace {

constexpr double kStepM = 0.25;  // ICP converges from half of it
constexpr double kStepRad = geometry::deg_to_rad(4.0);
constexpr double kMaxDistanceM = 0.25;  // a point this far from the map scores 0
constexpr std::size_t kNumPoints = 90;  // enough to rank poses; 45 misplace a rotation of mit-csail
constexpr std::size_t kMaxCandidates = 10;
constexpr double kDistinctM = 0.4;
constexpr double kDistinctRad = 0.1;
// Of two poses with the same score the one nearer to odometry is more likely. This much score makes
// up for a rotation of 90 degrees, or for twice the search distance. People around the robot take
// half of the score at the true pose; with 0.1 it is then found anywhere.
constexpr double kDeviationCost = 0.25;

struct Candidate {
  double score = 0.0;
  geometry::SE2 T_map_base;
};

/// Mean over every `stride`-th point: 1 on a map point, 0 from `kMaxDistanceM` on.
double quick_score(const PointMap& map, std::span<const OrientedPoint> scan, std::size_t stride,
                   const geometry::SE2& T_map_base) {
  const Eigen::Matrix2d R = T_map_base.rotation();
  const Eigen::Vector2d t = T_map_base.translation();
  double sum = 0.0;
  int points = 0;
  for (std::size_t i = 0; i < scan.size(); i += stride) {
    const OrientedPoint point{R * scan[i].p + t, R * scan[i].normal};
    if (const MapPoint* found = map.nearest(point, kMaxDistanceM)) {
      sum += 1.0 - (found->point.p - point.p).norm() / kMaxDistanceM;
    }
    ++points;
  }
  return points > 0 ? sum / points : 0.0;
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
    const double value = match.score - cost(match.T_map_base, guesses);
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

std::vector<geometry::SE2> PoseSearch::candidates(const PointMap& map,
                                                  std::span<const OrientedPoint> scan,
                                                  std::span<const geometry::SE2> guesses) const {
  const geometry::SE2& T_map_base_guess = guesses.front();
  const std::size_t stride = std::max<std::size_t>(1, scan.size() / kNumPoints);
  const int steps = static_cast<int>(params_.distance_m / kStepM);
  const int rotations = static_cast<int>(params_.rotation_rad / kStepRad);
  std::vector<Candidate> tried;
  for (int iyaw = -rotations; iyaw <= rotations; ++iyaw) {
    for (int ix = -steps; ix <= steps; ++ix) {
      for (int iy = -steps; iy <= steps; ++iy) {
        const geometry::SE2 pose{T_map_base_guess.x + ix * kStepM, T_map_base_guess.y + iy * kStepM,
                                 geometry::normalize_angle(T_map_base_guess.yaw + iyaw * kStepRad)};
        const double score = quick_score(map, scan, stride, pose);
        tried.push_back({score - cost(pose, guesses), pose});
      }
    }
  }
  std::stable_sort(tried.begin(), tried.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  std::vector<geometry::SE2> best;
  for (const Candidate& candidate : tried) {
    const bool is_new = std::all_of(best.begin(), best.end(), [&](const geometry::SE2& other) {
      return are_distinct(candidate.T_map_base, other);
    });
    if (is_new) {
      best.push_back(candidate.T_map_base);
    }
    if (best.size() == kMaxCandidates) {
      break;
    }
  }
  return best;
}

}  // namespace nodmap::slam2d
