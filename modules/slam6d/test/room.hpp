// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "common/geometry/time.hpp"
#include "common/scan/scan.hpp"

namespace nodmap::slam6d {

/// A world of infinite planes and boxes: a beam ends at the first one it meets.
struct Room {
  struct Wall {
    Eigen::Vector3d normal;
    double offset_m;  ///< normal . p of its points
  };

  std::vector<Wall> walls;
  std::vector<Eigen::AlignedBox3d> boxes = {};  ///< seen from outside

  [[nodiscard]] double range_m(const Eigen::Vector3d& p, const Eigen::Vector3d& direction) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Wall& wall : walls) {
      const double r = (wall.offset_m - wall.normal.dot(p)) / wall.normal.dot(direction);
      if (r > 0.0 && r < nearest) {
        nearest = r;
      }
    }
    for (const Eigen::AlignedBox3d& box : boxes) {
      nearest = std::min(nearest, range_to_box_m(box, p, direction));
    }
    return nearest;
  }

  [[nodiscard]] static double range_to_box_m(const Eigen::AlignedBox3d& box,
                                             const Eigen::Vector3d& p,
                                             const Eigen::Vector3d& direction) {
    const Eigen::Array3d a = (box.min() - p).array() / direction.array();
    const Eigen::Array3d b = (box.max() - p).array() / direction.array();
    const double enters_m = a.min(b).maxCoeff();
    return enters_m > 0.0 && enters_m < a.max(b).minCoeff()
               ? enters_m
               : std::numeric_limits<double>::infinity();
  }

  /// A corridor along x with floor, ceiling and two side walls. Nothing determines the position
  /// along it.
  [[nodiscard]] static Room corridor() {
    return {{{{0, 0, 1}, 0.0}, {{0, 0, 1}, 2.5}, {{0, 1, 0}, 1.1}, {{0, 1, 0}, -0.9}}};
  }

  /// The corridor with an end wall at either end, one of them slanting.
  [[nodiscard]] static Room hall() {
    Room room = corridor();
    room.walls.push_back({Eigen::Vector3d(1.0, 0.3, 0.0).normalized(), 6.0});
    room.walls.push_back({{1, 0, 0}, -4.0});
    return room;
  }
};

using Motion = std::function<geometry::SE3(time::Timestamp stamp)>;

/// A simulated SICK that nods between two pitches: 75 scans a second, each of 181 beams in half a
/// mirror revolution.
struct NoddingScanner {
  double lowest_rad = geometry::deg_to_rad(-40.0);
  double highest_rad = geometry::deg_to_rad(40.0);
  double step_rad = geometry::deg_to_rad(1.0);  ///< pitch from scan to scan
  double noise_m = 0.0;

  static constexpr time::Duration kPeriod = 13'320us;

  /// The pitch at a time: a triangle wave that starts at the lowest pitch, upwards.
  [[nodiscard]] double pitch_rad(time::Timestamp stamp) const {
    const double way = step_rad * time::ratio(stamp.time_since_epoch(), kPeriod);
    const double span = highest_rad - lowest_rad;
    const double phase = std::fmod(way, 2.0 * span);
    return phase < span ? lowest_rad + phase : highest_rad - (phase - span);
  }

  [[nodiscard]] scan::Scan scan(std::int64_t index, const Room& room, const Motion& T_world_base,
                                std::mt19937& random) const {
    scan::Scan scan;
    scan.stamp = time::Timestamp(index * kPeriod);
    scan.duration = kPeriod / 2;
    scan.seq = index;
    scan.angle_first_rad = geometry::deg_to_rad(-90.0);
    scan.angle_step_rad = geometry::deg_to_rad(1.0);
    scan.pitch_first_rad = pitch_rad(scan.stamp);
    scan.pitch_last_rad = pitch_rad(scan.last_stamp());
    scan.range_min_m = 0.05;
    scan.range_max_m = 80.0;
    scan.T_base_mount.translation() = Eigen::Vector3d(0.1, 0.0, 0.4);
    scan.ranges_m.assign(181, 0.0F);
    std::normal_distribution<double> noise(0.0, 1.0);
    for (std::size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
      const time::Timestamp beam_stamp = scan.stamp + std::chrono::duration_cast<time::Duration>(
                                                          scan.fraction(beam) * scan.duration);
      const geometry::SE3 T_world_mount = T_world_base(beam_stamp) * scan.T_base_mount;
      const Eigen::Vector3d direction =
          T_world_mount.linear() * scan::beam_direction(scan.angle_rad(beam), scan.pitch_rad(beam));
      scan.ranges_m[beam] = static_cast<float>(
          room.range_m(T_world_mount.translation(), direction) + noise_m * noise(random));
    }
    return scan;
  }
};

inline geometry::SE3 drive_ahead(double speed_mps, time::Timestamp stamp) {
  geometry::SE3 T_world_base = geometry::SE3::Identity();
  T_world_base.translation().x() = speed_mps * time::seconds(stamp.time_since_epoch());
  return T_world_base;
}

}  // namespace nodmap::slam6d
