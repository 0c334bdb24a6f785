// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "common/scan/scan.hpp"

/// A world of boxes, cylinders and a floor with exact ray casting, and a nodding scanner in it, for
/// the scene tests of the maps.
namespace nodmap::map_server::test {

using geometry::deg_to_rad;
using geometry::SE2;
using geometry::SE3;

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Box {
  Eigen::Vector3d low;
  Eigen::Vector3d high;

  /// Range along a ray by the slab method; infinity if it misses.
  [[nodiscard]] double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) const {
    double enter = 0.0;
    double leave = kInfinity;
    for (int i = 0; i < 3; ++i) {
      const double a = (low[i] - origin[i]) / ray[i];
      const double b = (high[i] - origin[i]) / ray[i];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (enter > leave || enter <= 0.0) {
      return kInfinity;
    }
    return enter;
  }
};

/// An upright cylinder on the floor.
struct Cylinder {
  Eigen::Vector2d centre;
  double radius_m = 0.0;
  double height_m = 0.0;

  [[nodiscard]] double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) const {
    const Eigen::Vector2d o = origin.head<2>() - centre;
    const Eigen::Vector2d d = ray.head<2>();
    const double a = d.squaredNorm();
    const double b = o.dot(d);
    const double root = b * b - a * (o.squaredNorm() - radius_m * radius_m);
    if (root < 0.0) {
      return kInfinity;
    }
    const double r = (-b - std::sqrt(root)) / a;
    if (r <= 0.0 || origin.z() + r * ray.z() > height_m) {
      return kInfinity;
    }
    return r;
  }
};

struct World {
  std::vector<Box> boxes;
  std::vector<Cylinder> cylinders;
  bool has_floor = true;

  [[nodiscard]] double cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) const {
    double range = has_floor && ray.z() < 0.0 ? -origin.z() / ray.z() : kInfinity;
    for (const Box& box : boxes) {
      range = std::min(range, box.cast(origin, ray));
    }
    for (const Cylinder& cylinder : cylinders) {
      range = std::min(range, cylinder.cast(origin, ray));
    }
    return range;
  }
};

/// Four walls around [x0, x1] x [y0, y1], without a ceiling.
inline World room(double x0, double x1, double y0, double y1, double height_m = 2.5) {
  World world;
  world.boxes = {{{x0 - 0.2, y0 - 0.2, 0}, {x0, y1 + 0.2, height_m}},
                 {{x1, y0 - 0.2, 0}, {x1 + 0.2, y1 + 0.2, height_m}},
                 {{x0 - 0.2, y0 - 0.2, 0}, {x1 + 0.2, y0, height_m}},
                 {{x0 - 0.2, y1, 0}, {x1 + 0.2, y1 + 0.2, height_m}}};
  return world;
}

/// The paper's scanner (II): 181 beams over 180 degrees at 75 Hz, nodding evenly between two
/// bounds.
class NoddingScanner {
 public:
  double low_rad = deg_to_rad(-20.8);  // sees all of the corridor from 1 m on
  double high_rad = deg_to_rad(5.1);
  double step_rad = deg_to_rad(1.0);  // from scan to scan
  double ahead_m = 0.0;
  double height_m = 0.38;
  double range_sigma_m = 0.0;
  double pitch_sigma_rad = 0.0;
  time::Duration period = 13'320us;

  static constexpr double kPeriodS = 0.01332;

  /// The next scan, taken from one pose.
  scan::Scan scan(const World& world, const SE2& T_world_base) {
    scan::Scan scan;
    scan.stamp = stamp_;
    scan.duration = period / 2;
    scan.seq = seq_++;
    scan.angle_first_rad = deg_to_rad(-90);
    scan.angle_step_rad = deg_to_rad(1);
    scan.range_min_m = 0.05;
    scan.range_max_m = 32.0;
    scan.T_base_mount.translation() = Eigen::Vector3d(ahead_m, 0, height_m);
    scan.pitch_first_rad = pitch_rad_;
    nod();
    scan.pitch_last_rad = 0.5 * (scan.pitch_first_rad + pitch_rad_);
    measure(world, T_world_base, scan);
    stamp_ += period;
    return scan;
  }

  /// Number of scans in one sweep from reversal to reversal.
  [[nodiscard]] int scans_per_sweep() const {
    return step_rad == 0.0 ? 1 : static_cast<int>(std::ceil((high_rad - low_rad) / step_rad)) + 1;
  }

  std::mt19937 random{75};

 private:
  void nod() {
    if (seq_ == 1) {
      pitch_rad_ = step_rad == 0.0 ? 0.0 : low_rad;
      return;
    }
    pitch_rad_ = std::clamp(pitch_rad_ + direction_ * step_rad, low_rad, high_rad);
    if (pitch_rad_ >= high_rad || pitch_rad_ <= low_rad) {
      direction_ = -direction_;
    }
  }

  void measure(const World& world, const SE2& T_world_base, scan::Scan& scan) {
    std::normal_distribution<double> noise(0.0, 1.0);
    scan::Scan truth = scan;
    const double pitch_error = pitch_sigma_rad * noise(random);
    truth.pitch_first_rad += pitch_error;
    truth.pitch_last_rad += pitch_error;
    truth.ranges_m.resize(181);
    const SE3 T = geometry::to_se3(T_world_base);
    const Eigen::Vector3d origin = T * scan::point_in_base(truth, 0, 0.0);
    for (std::size_t i = 0; i < 181; ++i) {
      const Eigen::Vector3d ray =
          T.linear() * scan::beam_direction(truth.angle_rad(i), truth.pitch_rad(i));
      const double range = world.cast(origin, ray);
      scan.ranges_m.push_back(static_cast<float>(
          range <= scan.range_max_m ? range + range_sigma_m * noise(random) : kInfinity));
    }
  }

  double pitch_rad_ = 0.0;
  double direction_ = 1.0;
  time::Timestamp stamp_ = time::from_utime(1'000'000);
  std::int64_t seq_ = 0;
};

}  // namespace nodmap::map_server::test
