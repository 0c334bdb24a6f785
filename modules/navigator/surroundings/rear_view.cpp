// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/surroundings/rear_view.hpp"

#include <algorithm>
#include <cmath>

#include "common/robot/infrared.hpp"

namespace nodmap::navigator {
namespace {

using robot::Infrared;

constexpr std::array kBehind{Infrared::kLeftBack, Infrared::kBack, Infrared::kRightBack};
constexpr std::array kBesideAndBehind{Infrared::kLeft, Infrared::kLeftBack, Infrared::kBack,
                                      Infrared::kRightBack, Infrared::kRight};
// BASE_SENSORS comes every 50 ms. At 0.05 m/s the robot moves 1 cm meanwhile.
constexpr time::Duration kFresh = 200ms;
// In this time the whole body passes what was measured behind it; odometry hardly drifts.
constexpr time::Duration kRemembered = 10s;

double range_of(const Proximity::Ranges& ranges_m, Infrared sensor) {
  return ranges_m[static_cast<std::size_t>(sensor)];
}

}  // namespace

void RearView::add(time::Timestamp stamp, const Proximity::Ranges& ranges_m,
                   const geometry::SE2& T_odom_base) {
  set_down_odom_ = set_down_odom_.value_or(T_odom_base.translation());
  has_left_ = has_left_ || (T_odom_base.translation() - *set_down_odom_).norm() > unseen_m_;
  if (has_left_) {
    points_.clear();
    return;
  }
  has_measured_ = has_measured_ || std::ranges::any_of(ranges_m, Proximity::is_reading);
  const bool have_answered = std::ranges::none_of(
      kBehind, [&](Infrared sensor) { return std::isnan(range_of(ranges_m, sensor)); });
  answered_at_ = have_answered ? std::optional(stamp) : std::nullopt;
  // abs(): a stamp that stepped back must not keep points for ever.
  std::erase_if(points_, [&](const Point& point) {
    return std::chrono::abs(stamp - point.stamp) > kRemembered;
  });
  for (const Infrared sensor : kBesideAndBehind) {
    const double range_m = range_of(ranges_m, sensor);
    if (Proximity::is_reading(range_m)) {
      const geometry::SE2 T_odom_sensor = T_odom_base * robot::mount_of(sensor);
      points_.push_back({stamp, T_odom_sensor * Eigen::Vector2d(range_m, 0.0)});
    }
  }
}

bool RearView::is_looking(time::Timestamp now) const {
  return has_measured_ && !has_left_ && answered_at_ &&
         std::chrono::abs(now - *answered_at_) <= kFresh;
}

double RearView::permitted_m(const geometry::SE2& T_odom_base) const {
  if (has_left_ || !set_down_odom_) {
    return 0.0;
  }
  return std::max(0.0, unseen_m_ - (T_odom_base.translation() - *set_down_odom_).norm());
}

Points RearView::points_base(const geometry::SE2& T_odom_base) const {
  const geometry::SE2 T_base_odom = T_odom_base.inverse();
  Points points;
  for (const Point& point : points_) {
    points.push_back(T_base_odom * point.p_odom);
  }
  return points;
}

}  // namespace nodmap::navigator
