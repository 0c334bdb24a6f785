// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/geometry/angle.hpp"

namespace nodmap::slam2d {
namespace {

// Within this distance it may be the same object: because of noise, an edge seen from the side, or
// an error of odometry.
constexpr double kMarginM = 0.3;
// At a correct pose this part of a scan may be people who have approached, and edges.
constexpr double kMaxContradictedRatio = 0.25;

std::size_t bin_of(const Eigen::Vector2d& direction, std::size_t num_bins) {
  const double turns = std::atan2(direction.y(), direction.x()) / (2.0 * geometry::kPi) + 0.5;
  return static_cast<std::size_t>(turns * static_cast<double>(num_bins)) % num_bins;
}

}  // namespace

// Space is free as far as the nearest point within a degree or two, so that a thin object between
// two beams does not count as free.
View::View(std::vector<Eigen::Vector2d> points_base, const Eigen::Vector2d& sensor_origin_base)
    : sensor_origin_base_(sensor_origin_base), points_base_(std::move(points_base)) {
  constexpr double kNothing = std::numeric_limits<double>::infinity();
  std::array<double, kNumBins> nearest_m{};
  nearest_m.fill(kNothing);
  for (const Eigen::Vector2d& p : points_base_) {
    const Eigen::Vector2d ray = p - sensor_origin_base_;
    double& nearest = nearest_m[bin_of(ray, kNumBins)];
    nearest = std::min(nearest, ray.norm());
  }
  for (std::size_t i = 0; i < kNumBins; ++i) {
    const double nearest = std::min(
        {nearest_m[(i + kNumBins - 1) % kNumBins], nearest_m[i], nearest_m[(i + 1) % kNumBins]});
    free_m_[i] = nearest == kNothing ? 0.0 : nearest;
    farthest_free_m_ = std::max(farthest_free_m_, free_m_[i]);
  }
}

bool View::saw_free(const Eigen::Vector2d& p_base) const {
  const Eigen::Vector2d ray = p_base - sensor_origin_base_;
  const double needed_m = ray.norm() + kMarginM;
  return needed_m < farthest_free_m_ && needed_m < free_m_[bin_of(ray, kNumBins)];
}

bool View::contradicts(const View& other, const geometry::SE2& T_this_other) const {
  return saw_through(other, T_this_other) || other.saw_through(*this, T_this_other.inverse());
}

// Whether beams of this view have passed through what the other one measured. Compares only points
// in directions in which this view has measured a range.
bool View::saw_through(const View& other, const geometry::SE2& T_this_other) const {
  std::size_t compared = 0;
  std::size_t contradicted = 0;
  for (const Eigen::Vector2d& p_other : other.points_base_) {
    const Eigen::Vector2d p = T_this_other * p_other;
    compared += free_m_[bin_of(p - sensor_origin_base_, kNumBins)] > 0.0 ? 1 : 0;
    contradicted += saw_free(p) ? 1 : 0;
  }
  return contradicted >= kMinPoints &&
         static_cast<double>(contradicted) > kMaxContradictedRatio * static_cast<double>(compared);
}

}  // namespace nodmap::slam2d
