// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/scan_line.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::map_server {
namespace {

// Two neighbouring readings belong to one surface if the beams meet it at more than 3 degrees.
// Otherwise they are treated as an edge.
const double kCotangentOfGrazing = 1.0 / std::tan(geometry::deg_to_rad(3.0));

// atan2 with an error below 2e-6 rad, a ten-thousandth of the angle between beams. The library's
// atan2 would take a quarter of the time of a map update (bench/map_server_bench).
double quick_atan2(double y, double x) {
  const double ax = std::abs(x);
  const double ay = std::abs(y);
  const double t = std::min(ax, ay) / std::max(ax, ay);
  const double s = t * t;
  const double octant =
      t *
      (0.99997726 + s * (-0.33262347 +
                         s * (0.19354346 + s * (-0.11643287 + s * (0.05265332 - s * 0.01172120)))));
  const double quadrant = ay > ax ? 0.5 * geometry::kPi - octant : octant;
  return std::copysign(x < 0.0 ? geometry::kPi - quadrant : quadrant, y);
}

Eigen::Vector3d sensor_origin_in_base(const scan::Scan& scan, double pitch_rad) {
  return scan.T_base_mount * (geometry::pitch_rotation(pitch_rad) * scan.mirror_offset_m);
}

}  // namespace

std::optional<SlantedPlane> laser_plane(const scan::Scan& scan, double pitch_rad) {
  const Eigen::Vector3d normal =
      scan.T_base_mount.linear() * Eigen::Vector3d(-std::sin(pitch_rad), 0.0, std::cos(pitch_rad));
  if (std::abs(normal.z()) < 0.05) {
    return std::nullopt;
  }
  return SlantedPlane{normal.dot(sensor_origin_in_base(scan, pitch_rad)) / normal.z(),
                      -normal.head<2>() / normal.z()};
}

ScanLine::ScanLine(const scan::Scan& scan) : scan_(&scan) {
  const double pitch = scan.pitch_mid_rad();
  sensor_origin_ = sensor_origin_in_base(scan, pitch);
  forward_ = scan.T_base_mount.linear() * Eigen::Vector3d(std::cos(pitch), 0.0, std::sin(pitch));
  left_ = scan.T_base_mount.linear().col(1);
  first_plane_ = laser_plane(scan, scan.pitch_first_rad);
  last_plane_ = laser_plane(scan, scan.pitch_last_rad);
  beams_per_rad_ = 1.0 / std::abs(scan.angle_step_rad);
  last_beam_ = static_cast<double>(scan.ranges_m.size()) - 1.0;
  closes_the_circle_ = std::abs((last_beam_ + 1.0) * std::abs(scan.angle_step_rad) -
                                2.0 * geometry::kPi) < 0.5 * std::abs(scan.angle_step_rad);
}

std::optional<ScanLine::Crossing> ScanLine::crossing_at(const Eigen::Vector2d& p_base) const {
  if (last_beam_ < 1.0 || !first_plane_ || !last_plane_) {
    return std::nullopt;
  }
  const double z_first = first_plane_->height_m(p_base);
  const double z_last = last_plane_->height_m(p_base);
  Eigen::Vector3d sight(p_base.x(), p_base.y(), 0.5 * (z_first + z_last));
  sight -= sensor_origin_;
  const double angle = quick_atan2(sight.dot(left_), sight.dot(forward_));
  const double first = scan_->angle_first_rad;
  double from_first_rad = scan_->angle_step_rad > 0.0 ? angle - first : first - angle;
  while (from_first_rad < 0.0) {  // at most twice: the first beam is within 2 pi of 0
    from_first_rad += 2.0 * geometry::kPi;
  }
  while (from_first_rad >= 2.0 * geometry::kPi) {
    from_first_rad -= 2.0 * geometry::kPi;
  }
  const double beams = from_first_rad * beams_per_rad_;  // from the first beam
  Crossing crossing;
  if (beams <= last_beam_) {
    crossing.beam =
        std::min(static_cast<std::size_t>(static_cast<int>(beams)), scan_->ranges_m.size() - 2);
    crossing.next = crossing.beam + 1;
  } else if (closes_the_circle_) {
    crossing.beam = scan_->ranges_m.size() - 1;
  } else {
    return std::nullopt;  // NaN, too
  }
  crossing.between = std::min(beams - static_cast<double>(crossing.beam), 1.0);
  crossing.height_m = z_first + std::min(beams / last_beam_, 1.0) * (z_last - z_first);
  sight.z() = crossing.height_m - sensor_origin_.z();
  crossing.range_m = sight.norm();
  return crossing;
}

std::optional<double> ScanLine::measured_range_m(const Crossing& crossing) const {
  const std::size_t nearer = crossing.between < 0.5 ? crossing.beam : crossing.next;
  if (!scan_->is_hit(nearer)) {
    return std::nullopt;
  }
  const auto r1 = static_cast<double>(scan_->ranges_m[crossing.beam]);
  const auto r2 = static_cast<double>(scan_->ranges_m[crossing.next]);
  const double widest = kCotangentOfGrazing * std::abs(scan_->angle_step_rad) * std::min(r1, r2);
  const bool one_surface =
      scan_->is_hit(crossing.beam) && scan_->is_hit(crossing.next) && std::abs(r1 - r2) <= widest;
  if (!one_surface) {
    return static_cast<double>(scan_->ranges_m[nearer]);
  }
  // Along a straight line the inverse of the range is linear in a small angle.
  return r1 * r2 / (r1 * crossing.between + r2 * (1.0 - crossing.between));
}

bool ScanLine::reaches_beyond(std::size_t beam, double range_m) const {
  const auto r = static_cast<double>(scan_->ranges_m[beam]);
  if (std::isinf(r)) {
    return r > 0.0 && range_m < scan_->range_max_m;
  }
  return scan_->is_hit(beam) && r > range_m;
}

}  // namespace nodmap::map_server
