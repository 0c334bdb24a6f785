// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/contact/slip.hpp"

namespace nodmap::navigator {
namespace {

constexpr time::Duration kWindow = 1s;
// With fewer poses there is no other interval to compare with.
constexpr std::size_t kMinPoses = 3;
constexpr double kMinDistanceM = 0.12;
// Without any one interval the wheels must still count this much.
constexpr double kMinRestM = 0.06;
// The wheels slip if, by 2D SLAM, the robot has moved less than this fraction of what they count.
constexpr double kMovedFraction = 0.33;

}  // namespace

std::optional<geometry::SE2> SlipMonitor::update(time::Timestamp stamp,
                                                 const geometry::SE2& T_odom_base,
                                                 const geometry::SE2& T_map_base) {
  if (!poses_.empty() && stamp <= poses_.back().stamp) {
    poses_.clear();
  }
  poses_.push_back({stamp, T_odom_base, T_map_base.translation()});
  while (poses_.size() > kMinPoses && stamp - poses_.front().stamp > kWindow) {
    poses_.pop_front();
  }
  if (!is_slip()) {
    return std::nullopt;
  }
  const geometry::SE2 T_odom_before = poses_.front().T_odom_base;
  poses_.clear();
  return T_odom_before;
}

// Whether there is slip over all poses, and also without any one of the intervals between them.
bool SlipMonitor::is_slip() const {
  const auto shows_slip = [](const Eigen::Vector2d& by_wheels, const Eigen::Vector2d& by_slam,
                             double least_m) {
    return by_wheels.norm() >= least_m && by_slam.norm() <= kMovedFraction * by_wheels.norm();
  };
  const auto p_odom = [this](std::size_t i) { return poses_[i].T_odom_base.translation(); };
  const Eigen::Vector2d by_wheels = p_odom(poses_.size() - 1) - p_odom(0);
  const Eigen::Vector2d by_slam = poses_.back().p_map - poses_.front().p_map;
  if (!shows_slip(by_wheels, by_slam, kMinDistanceM)) {
    return false;
  }
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    if (!shows_slip(by_wheels - (p_odom(i) - p_odom(i - 1)),
                    by_slam - (poses_[i].p_map - poses_[i - 1].p_map), kMinRestM)) {
      return false;
    }
  }
  return true;
}

}  // namespace nodmap::navigator
