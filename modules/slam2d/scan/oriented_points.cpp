// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/oriented_points.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::slam2d {
namespace {

constexpr double kNeighbourRadiusM = 0.3;
// Neighbours on each side. Near a wall there are more within reach, but they add nothing.
constexpr std::size_t kMaxNeighbours = 8;

// Sums over a point and its neighbours, relative to the point.
struct NeighbourSums {
  double n = 1.0;  // the point itself
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d outer = Eigen::Matrix2d::Zero();

  // Returns false, and adds nothing, for a point beyond a jump in range.
  bool add(const Eigen::Vector2d& d) {
    if (d.squaredNorm() > kNeighbourRadiusM * kNeighbourRadiusM) {
      return false;
    }
    n += 1.0;
    sum += d;
    outer += d * d.transpose();
    return true;
  }
};

// A fraction of a motion. Within the 13 ms of a scan a straight line is as good as the arc.
geometry::SE2 interpolate(const geometry::SE2& motion, double fraction) {
  return {fraction * motion.x, fraction * motion.y, fraction * motion.yaw};
}

}  // namespace

std::vector<OrientedPoint> transformed(const geometry::SE2& T_a_b,
                                       std::span<const OrientedPoint> points_b) {
  const Eigen::Matrix2d R = T_a_b.rotation();  // once: sine and cosine take longer than the rest
  const double c = R(0, 0);
  const double s = R(1, 0);
  std::vector<OrientedPoint> points_a;
  points_a.reserve(points_b.size());
  for (const auto& [p, normal] : points_b) {
    points_a.push_back(
        {{T_a_b.x + c * p.x() - s * p.y(), T_a_b.y + s * p.x() + c * p.y()}, R * normal});
  }
  return points_a;
}

Eigen::Vector2d estimate_normal(std::span<const Eigen::Vector2d> points, std::size_t index,
                                const Eigen::Vector2d& sensor_origin) {
  const Eigen::Vector2d& middle = points[index];
  NeighbourSums sums;
  const std::size_t end = std::min(points.size(), index + 1 + kMaxNeighbours);
  for (std::size_t i = index + 1; i < end && sums.add(points[i] - middle); ++i) {
  }
  const std::size_t begin = index > kMaxNeighbours ? index - kMaxNeighbours : 0;
  for (std::size_t i = index; i > begin && sums.add(points[i - 1] - middle); --i) {
  }
  if (sums.n < 3.0) {
    return Eigen::Vector2d::Zero();
  }
  const Eigen::Vector2d mean = sums.sum / sums.n;
  const Eigen::Matrix2d scatter = sums.outer / sums.n - mean * mean.transpose();
  const double angle = 0.5 * std::atan2(2.0 * scatter(0, 1), scatter(0, 0) - scatter(1, 1));
  const Eigen::Vector2d normal(-std::sin(angle), std::cos(angle));
  return normal.dot(sensor_origin - middle) < 0.0 ? Eigen::Vector2d(-normal) : normal;
}

std::span<const OrientedPoint> OrientedPointExtractor::extract(const scan::Scan& scan,
                                                               const geometry::SE2& T_first_last) {
  positions_.clear();
  for (const scan::ScanProjector::Point& hit : projector_.hits(scan)) {
    const geometry::SE2 T_first_beam = interpolate(T_first_last, scan.fraction(hit.beam));
    positions_.emplace_back(T_first_beam * Eigen::Vector2d(hit.p_base.head<2>()));
  }
  return extract(positions_, scan::point_in_base(scan, 0, 0.0).head<2>());
}

std::span<const OrientedPoint> OrientedPointExtractor::extract(
    std::span<const Eigen::Vector2d> points_base, const Eigen::Vector2d& sensor_origin_base) {
  points_.clear();
  for (std::size_t i = 0; i < points_base.size(); ++i) {
    points_.push_back({points_base[i], estimate_normal(points_base, i, sensor_origin_base)});
  }
  return points_;
}

}  // namespace nodmap::slam2d
