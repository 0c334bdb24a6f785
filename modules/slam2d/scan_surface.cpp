// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan_surface.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::slam2d {
namespace {

constexpr double kReachM = 0.3;
constexpr std::size_t kMaxNeighbours = 8;  // on each side: close to a wall more add nothing

/// Sums over points relative to the one in the middle.
struct Spread {
  double n = 1.0;  // the middle itself
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d outer = Eigen::Matrix2d::Zero();

  /// Whether the point belongs to the surface: a jump ends it.
  bool add(const Eigen::Vector2d& d) {
    if (d.squaredNorm() > kReachM * kReachM) {
      return false;
    }
    n += 1.0;
    sum += d;
    outer += d * d.transpose();
    return true;
  }
};

/// The motion up to a fraction of it. Within the 13 ms of a scan the chord is as good as the arc.
geometry::SE2 part_of(const geometry::SE2& motion, double fraction) {
  return {fraction * motion.x, fraction * motion.y, fraction * motion.yaw};
}

}  // namespace

Eigen::Vector2d normal_at(std::span<const Eigen::Vector2d> points, std::size_t index,
                          const Eigen::Vector2d& eye) {
  const Eigen::Vector2d& middle = points[index];
  Spread spread;
  const std::size_t end = std::min(points.size(), index + 1 + kMaxNeighbours);
  for (std::size_t i = index + 1; i < end && spread.add(points[i] - middle); ++i) {
  }
  const std::size_t begin = index > kMaxNeighbours ? index - kMaxNeighbours : 0;
  for (std::size_t i = index; i > begin && spread.add(points[i - 1] - middle); --i) {
  }
  if (spread.n < 3.0) {
    return Eigen::Vector2d::Zero();
  }
  const Eigen::Vector2d mean = spread.sum / spread.n;
  const Eigen::Matrix2d scatter = spread.outer / spread.n - mean * mean.transpose();
  const double along = 0.5 * std::atan2(2.0 * scatter(0, 1), scatter(0, 0) - scatter(1, 1));
  const Eigen::Vector2d normal(-std::sin(along), std::cos(along));
  return normal.dot(eye - middle) < 0.0 ? Eigen::Vector2d(-normal) : normal;
}

std::span<const SurfacePoint> ScanSurface::points(const scan::Scan& scan,
                                                  const geometry::SE2& T_first_last) {
  hits_.clear();
  points_.clear();
  for (const scan::ScanProjector::Point& hit : projector_.hits(scan)) {
    const geometry::SE2 T_first_beam = part_of(T_first_last, scan.fraction(hit.beam));
    hits_.emplace_back(T_first_beam * Eigen::Vector2d(hit.p_base.head<2>()));
  }
  const Eigen::Vector2d eye = scan::point_in_base(scan, 0, 0.0).head<2>();
  for (std::size_t i = 0; i < hits_.size(); ++i) {
    points_.push_back({hits_[i], normal_at(hits_, i, eye)});
  }
  return points_;
}

}  // namespace nodmap::slam2d
