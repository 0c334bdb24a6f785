// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/approach.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace {

/// Nearer by less is noise of the laser and of odometry in a turn: 1 to 2 cm each.
constexpr double kNearerM = 0.06;
constexpr std::int64_t kGiveWayUs = 1'000'000;

int sector_of(double compass_rad, int sectors) {
  const double share = compass_rad / (2.0 * geometry::kPi) * sectors;
  return (static_cast<int>(std::floor(share)) % sectors + sectors) % sectors;
}

}  // namespace

Approach::Sectors Approach::nearest(double heading_rad, const Points& points_base) {
  Sectors nearest_m;
  nearest_m.fill(std::numeric_limits<double>::infinity());
  for (const Eigen::Vector2d& p : points_base) {
    const int sector = sector_of(heading_rad + std::atan2(p.y(), p.x()), kSectors);
    double& distance_m = nearest_m[static_cast<std::size_t>(sector)];
    distance_m = std::min(distance_m, p.norm());
  }
  return nearest_m;
}

void Approach::look(std::int64_t utime_us, double heading_rad, const Points& points_base,
                    const View& view) {
  const Sectors now_m = nearest(heading_rad, points_base);
  if (!known_m_) {
    known_m_ = now_m;
    return;
  }
  const Sectors before_m = *known_m_;
  for (int i = 0; i < kSectors; ++i) {
    const auto at = [i](const Sectors& sectors_m, int beside) {
      return sectors_m[static_cast<std::size_t>((i + beside + kSectors) % kSectors)];
    };
    // A pole on the border of two sectors is now in one, now in the other.
    const double known_m = std::min({at(before_m, -1), at(before_m, 0), at(before_m, 1)});
    const double direction_rad =
        geometry::angle_difference((i + 0.5) * 2.0 * geometry::kPi / kSectors, heading_rad);
    const bool is_nearer = at(now_m, 0) < std::min(known_m - kNearerM, reach_m_);
    if (is_nearer && view.trusts(direction_rad, half_sweeps_)) {
      came_us_ = utime_us;
    }
    // What comes slowly is measured from where it began.
    double& kept_m = (*known_m_)[static_cast<std::size_t>(i)];
    if (is_nearer || at(now_m, 0) > kept_m || !std::isfinite(kept_m)) {
      kept_m = at(now_m, 0);
    }
  }
}

bool Approach::is_close(std::int64_t utime_us) const {
  // A stamp that stepped back must not prolong the wait.
  return came_us_ && std::abs(utime_us - *came_us_) < kGiveWayUs;
}

void Approach::forget() {
  known_m_.reset();
}

}  // namespace nodmap::navigator
