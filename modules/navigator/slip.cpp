// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/slip.hpp"

namespace nodmap::navigator {
namespace {

constexpr time::Duration kWindow = 1s;
constexpr double kLeastDistanceM = 0.12;
/// The wheels slip if, by 2D SLAM, the robot has moved less than this fraction of what they count.
constexpr double kMovedFraction = 0.33;

}  // namespace

bool SlipMonitor::update(time::Timestamp stamp, const geometry::SE2& T_odom_base,
                         const geometry::SE2& T_map_base) {
  if (!poses_.empty() && stamp <= poses_.back().stamp) {
    poses_.clear();
  }
  poses_.push_back({stamp, T_odom_base.translation(), T_map_base.translation()});
  while (stamp - poses_.front().stamp > kWindow) {
    poses_.pop_front();
  }
  const double by_wheels_m = (poses_.back().p_odom - poses_.front().p_odom).norm();
  const double by_slam_m = (poses_.back().p_map - poses_.front().p_map).norm();
  if (by_wheels_m < kLeastDistanceM || by_slam_m > kMovedFraction * by_wheels_m) {
    return false;
  }
  poses_.clear();
  return true;
}

}  // namespace nodmap::navigator
