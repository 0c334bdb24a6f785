// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/pose_search.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::slam2d {
namespace {

constexpr double kStepM = 0.25;  // ICP comes in from half of it
constexpr double kStepRad = geometry::deg_to_rad(4.0);
constexpr double kReachM = 0.25;     // a point this far from the map counts 0
constexpr std::size_t kPoints = 90;  // enough to rank poses; 45 misplace one turn of csail
constexpr std::size_t kMaxCandidates = 10;
constexpr double kDistinctM = 0.4;
constexpr double kDistinctRad = 0.1;
constexpr double kDepartureCost = 0.1;  // the nearer of two equal poses is the likelier

struct Candidate {
  double score = 0.0;
  geometry::SE2 T_map_base;
};

/// Mean nearness of every `stride`-th point to the map, 0..1.
double nearness(const PointMap& map, std::span<const SurfacePoint> scan, std::size_t stride,
                const geometry::SE2& T_map_base) {
  const Eigen::Matrix2d R = T_map_base.rotation();
  const Eigen::Vector2d t = T_map_base.translation();
  double sum = 0.0;
  int points = 0;
  for (std::size_t i = 0; i < scan.size(); i += stride) {
    const SurfacePoint point{R * scan[i].p + t, R * scan[i].normal};
    if (const PointMap::Landmark* found = map.nearest(point, kReachM)) {
      sum += 1.0 - (found->point.p - point.p).norm() / kReachM;
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

double PoseSearch::departure(const geometry::SE2& pose, const geometry::SE2& guess) const {
  const double way = std::hypot(pose.x - guess.x, pose.y - guess.y);
  const double turn = std::abs(geometry::angle_difference(pose.yaw, guess.yaw));
  return turn / (0.5 * geometry::kPi) + way / std::max(2.0 * params_.search_distance_m, kStepM);
}

std::vector<geometry::SE2> PoseSearch::candidates(const PointMap& map,
                                                  std::span<const SurfacePoint> scan,
                                                  const geometry::SE2& T_map_base_guess) const {
  const std::size_t stride = std::max<std::size_t>(1, scan.size() / kPoints);
  const int steps = static_cast<int>(params_.search_distance_m / kStepM);
  const int turns = static_cast<int>(params_.search_rotation_rad / kStepRad);
  std::vector<Candidate> tried;
  for (int turn = -turns; turn <= turns; ++turn) {
    for (int ix = -steps; ix <= steps; ++ix) {
      for (int iy = -steps; iy <= steps; ++iy) {
        const geometry::SE2 pose{T_map_base_guess.x + ix * kStepM, T_map_base_guess.y + iy * kStepM,
                                 geometry::normalize_angle(T_map_base_guess.yaw + turn * kStepRad)};
        const double score = nearness(map, scan, stride, pose);
        tried.push_back({score - kDepartureCost * departure(pose, T_map_base_guess), pose});
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
