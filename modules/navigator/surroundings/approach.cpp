// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/surroundings/approach.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/angle.hpp"
#include "modules/navigator/local_map/local_map.hpp"

namespace nodmap::navigator {
namespace {

// Smaller changes are noise of the laser and of odometry in a rotation: 1 to 2 cm each.
constexpr double kApproachM = 0.06;
constexpr time::Duration kWait = 1s;
// The reference point moves on when it is this far behind the robot: until then everything is seen
// from about the same side.
constexpr double kReferenceM = 0.3;
// Points within this distance belong to one object.
constexpr double kOneThingM = 0.1;
// A person who approaches is measured below the first of these heights and above the second.
constexpr double kFeetM = 0.2;
constexpr double kLowThingM = 0.12;

int sector_of(double compass_rad, int sectors) {
  const double sector = compass_rad / (2.0 * geometry::kPi) * sectors;
  return (static_cast<int>(std::floor(sector)) % sectors + sectors) % sectors;
}

// Whether beams have hit something at a point of the obstacle map more than once. Nothing is where
// a mixed pixel is: the local map leaves out most of them, and the few others hit different
// places.
bool is_hit_again(const Eigen::Vector2d& p_odom, const LocalMap& local_map) {
  const double cell_m = local_map.grid().cell_size_m();
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      const LocalCell* cell = local_map.cell_at(p_odom + cell_m * Eigen::Vector2d(dx, dy));
      if (cell != nullptr && cell->obstacle > evidence::kCertain) {
        return true;
      }
    }
  }
  return false;
}

// Whether something has moved to where floor was seen. The laser sees a person's legs at all
// heights within one sweep. Less than that has not moved: a low object, around which floor was
// seen before a line fell on it, or a board, under which floor is still seen. Brake stops for
// these as well.
bool has_come(const Eigen::Vector2d& p_odom, const LocalMap& local_map) {
  if (!local_map.seen_floor().is_around(p_odom)) {
    return false;
  }
  const auto span = local_map.obstacle_span(p_odom, kOneThingM);
  return span && span->low_m < kFeetM && span->high_m > kLowThingM;
}

}  // namespace

Approach::Sectors Approach::nearest(const geometry::SE2& T_odom_base,
                                    const Points& points_base) const {
  Sectors sectors;
  sectors.fill({std::numeric_limits<double>::infinity(), Eigen::Vector2d::Zero()});
  // T_odom_base * p, with the trigonometry done once for all points.
  const double c = std::cos(T_odom_base.yaw);
  const double s = std::sin(T_odom_base.yaw);
  for (const Eigen::Vector2d& p_base : points_base) {
    const Eigen::Vector2d p_odom(T_odom_base.x + c * p_base.x() - s * p_base.y(),
                                 T_odom_base.y + s * p_base.x() + c * p_base.y());
    const Eigen::Vector2d offset = p_odom - reference_odom_;
    const int sector = sector_of(std::atan2(offset.y(), offset.x()), kSectors);
    Nearest& so_far = sectors[static_cast<std::size_t>(sector)];
    if (offset.norm() < so_far.distance_m) {
      so_far = {offset.norm(), p_base};
    }
  }
  return sectors;
}

void Approach::update(const Situation& now, double reach_m, const Points& points_base) {
  if (known_) {
    compare(nearest(now.T_odom_base, points_base), now, reach_m);
  }
  if (!known_ || (now.T_odom_base.translation() - reference_odom_).norm() > kReferenceM) {
    reference_odom_ = now.T_odom_base.translation();
    known_ = nearest(now.T_odom_base, points_base);
  }
}

void Approach::compare(const Sectors& sectors, const Situation& now, double reach_m) {
  const LocalMap* local_map = now.needs_seen_floor() ? now.local_map : nullptr;
  const Sectors before = *known_;
  for (int i = 0; i < kSectors; ++i) {
    const auto known_m = [&](int beside) {
      return before[static_cast<std::size_t>((i + beside + kSectors) % kSectors)].distance_m;
    };
    const Nearest& there = sectors[static_cast<std::size_t>(i)];
    // A thin object on the border of two sectors may appear in either.
    const double nearest_known_m = std::min({known_m(-1), known_m(0), known_m(1)});
    const bool is_nearer = there.distance_m < nearest_known_m - kApproachM;
    const Eigen::Vector2d p_odom = now.T_odom_base * there.p_base;
    if (is_nearer && local_map != nullptr && !is_hit_again(p_odom, *local_map)) {
      continue;
    }
    const double direction_rad = std::atan2(there.p_base.y(), there.p_base.x());
    if (is_nearer && there.p_base.norm() < reach_m && now.has_seen(direction_rad) &&
        (local_map == nullptr || has_come(p_odom, *local_map))) {
      detected_at_ = now.stamp;
    }
    // A slow object is compared with the distance at which it started. What is out of reach, or was
    // in the sector beside this one, is kept as well: otherwise it would be new in a moment.
    Nearest& kept = (*known_)[static_cast<std::size_t>(i)];
    if (there.distance_m > kept.distance_m || there.distance_m < kept.distance_m - kApproachM) {
      kept = there;
    }
  }
}

bool Approach::is_detected(time::Timestamp stamp) const {
  // A stamp that stepped back must not prolong the wait.
  return detected_at_ && std::chrono::abs(stamp - *detected_at_) < kWait;
}

}  // namespace nodmap::navigator
