// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/walls_behind.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::slam2d {
namespace {

// In this time the robot drives 15 cm and its tilt hardly changes.
constexpr time::Duration kMaxAge = 300ms;
// More than a fast scanner sends in this time; stamps may stand still.
constexpr std::size_t kMaxRecent = 100;
// Above it the laser sees ceilings and lamps rather than walls.
constexpr double kMaxPitchRad = geometry::deg_to_rad(20.0);
constexpr double kMaxHeightM = 1.8;
// A wall is vertical over so many successive scans.
constexpr std::size_t kNumScans = 3;
// Several times the noise of a range; and a wall that a robot on a ramp of 12 degrees sees.
constexpr double kVerticalM = 0.03;
constexpr double kVerticalRatio = 0.25;

}  // namespace

void WallsBehind::add(const scan::Scan& scan) {
  recent_.push_back(scan);
  while (scan.stamp - recent_.front().stamp > kMaxAge || recent_.front().stamp > scan.stamp ||
         recent_.size() > kMaxRecent) {
    recent_.pop_front();
  }
}

std::vector<const scan::Scan*> WallsBehind::scans_above(const scan::Scan& level) const {
  std::vector<const scan::Scan*> above;
  double pitch_rad = level.pitch_mid_rad();
  for (std::size_t i = recent_.size(); i > 0; --i) {
    const scan::Scan& scan = recent_[i - 1];
    if (scan.stamp >= level.stamp || scan.ranges_m.size() != level.ranges_m.size()) {
      continue;
    }
    if (scan.pitch_mid_rad() <= pitch_rad || scan.pitch_mid_rad() > kMaxPitchRad) {
      break;  // before the last reversal
    }
    pitch_rad = scan.pitch_mid_rad();
    above.push_back(&scan);
  }
  return above;
}

std::optional<Eigen::Vector2d> WallsBehind::wall_at(std::size_t beam,
                                                    const Eigen::Vector2d& sensor_origin) const {
  for (std::size_t i = 0; i + kNumScans <= above_.size(); ++i) {
    const auto& low = above_[i][beam];
    const auto& middle = above_[i + 1][beam];
    const auto& high = above_[i + 2][beam];
    if (!low || !middle || !high || high->z() > kMaxHeightM) {
      continue;
    }
    const auto distance_m = [&](const Eigen::Vector3d& p) {
      return (p.head<2>() - sensor_origin).norm();
    };
    const double limit_m = std::max(kVerticalM, kVerticalRatio * (high->z() - low->z()));
    if (std::abs(distance_m(*high) - distance_m(*low)) < limit_m &&
        std::abs(distance_m(*middle) - distance_m(*low)) < limit_m) {
      return (low->head<2>() + middle->head<2>() + high->head<2>()) / 3.0;
    }
  }
  return std::nullopt;
}

std::vector<std::optional<Eigen::Vector2d>> WallsBehind::find(const scan::Scan& level,
                                                              const std::vector<bool>& is_sloped,
                                                              const Place& place) {
  above_.clear();
  for (const scan::Scan* scan : scans_above(level)) {
    const std::optional<SweepScan> placed = place(*scan);
    if (!placed) {
      break;
    }
    above_.emplace_back(deskewed(*placed, projector_));
  }
  const Eigen::Vector2d sensor_origin = scan::point_in_base(level, 0, 0.0).head<2>();
  std::vector<std::optional<Eigen::Vector2d>> walls(is_sloped.size());
  for (std::size_t beam = 0; beam < is_sloped.size(); ++beam) {
    if (is_sloped[beam]) {
      walls[beam] = wall_at(beam, sensor_origin);
    }
  }
  return walls;
}

}  // namespace nodmap::slam2d
