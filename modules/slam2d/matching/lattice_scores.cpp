// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/matching/lattice_scores.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace nodmap::slam2d {
namespace {

constexpr double kReachM2 = LatticeScores::kMaxDistanceM * LatticeScores::kMaxDistanceM;

// The lines of the lattice within reach of a map point, along one axis.
struct LinesInReach {
  // `offset_m`: of the map point from the first line; `last`: the last line.
  LinesInReach(double offset_m, int last) {
    constexpr double kReach = LatticeScores::kMaxDistanceM / LatticeScores::kStepM + 1e-9;
    const double at = offset_m / LatticeScores::kStepM;
    if (at > -kReach && at < last + kReach) {
      begin = at < kReach ? 0 : static_cast<int>(at - kReach) + 1;
      end = std::min(static_cast<int>(at + kReach), last) + 1;
    }
  }
  int begin = 0;
  int end = 0;
};

}  // namespace

LatticeScores::LatticeScores(const PointMap& map, const Eigen::Vector2d& middle, int steps)
    : map_(map), middle_(middle), steps_(steps) {
  const auto lines = static_cast<std::size_t>(2 * steps + 1);
  sums_.resize(lines * lines);
  nearest_m2_.assign(lines * lines, kReachM2);
}

void LatticeScores::compute(std::span<const OrientedPoint> scan, double yaw_rad) {
  const Eigen::Matrix2d R = geometry::SE2{0.0, 0.0, yaw_rad}.rotation();
  const double radius_m = steps_ * kStepM + kMaxDistanceM;
  num_points_ = std::max(1.0, static_cast<double>(scan.size()));
  std::fill(sums_.begin(), sums_.end(), 0.0);
  for (const auto& [p, normal_base] : scan) {
    const Eigen::Vector2d moment_arm = R * p;
    const Eigen::Vector2d normal = R * normal_base;
    bool is_near = false;
    map_.for_each_around(moment_arm + middle_, radius_m,
                         [&](const Eigen::Vector2d& p_map, std::uint32_t index) {
                           if (have_similar_normals(normal, map_.points()[index].point.normal)) {
                             compare(moment_arm, p_map);
                             is_near = true;
                           }
                         });
    if (!is_near) {
      continue;
    }
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      sums_[i] += 1.0 - std::sqrt(nearest_m2_[i]) / kMaxDistanceM;
      nearest_m2_[i] = kReachM2;
    }
  }
}

// Compares a point of the scan, `moment_arm` from each place, with a map point.
void LatticeScores::compare(const Eigen::Vector2d& moment_arm, const Eigen::Vector2d& p_map) {
  const Eigen::Vector2d offset = p_map - (moment_arm + position(-steps_, -steps_));
  const LinesInReach x(offset.x(), 2 * steps_);
  const LinesInReach y(offset.y(), 2 * steps_);
  for (int ix = x.begin; ix < x.end; ++ix) {
    for (int iy = y.begin; iy < y.end; ++iy) {
      const Eigen::Vector2d p = moment_arm + position(ix - steps_, iy - steps_);
      double& nearest_m2 = nearest_m2_[index(ix - steps_, iy - steps_)];
      nearest_m2 = std::min(nearest_m2, (p_map - p).squaredNorm());
    }
  }
}

}  // namespace nodmap::slam2d
