// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/level_scan.hpp"

#include <algorithm>
#include <utility>

namespace nodmap::slam2d {

bool LevelScanInput::add_odometry(time::Timestamp stamp, const geometry::SE3& T_odom_base) {
  if (!odometry_.add(stamp, T_odom_base)) {
    return false;
  }
  odometry_gap_s_ =
      std::max(odometry_gap_s_, time::seconds(stamp - odometry_stamp_.value_or(stamp)));
  odometry_stamp_ = stamp;
  return true;
}

geometry::SE2 LevelScanInput::change_odometry_frame(const geometry::SE3& T_new_odom_base) {
  geometry::SE2 T_old_new;
  if (const auto T_old_odom_base = odometry_.newest()) {
    T_old_new = geometry::to_se2(*T_old_odom_base) * geometry::to_se2(T_new_odom_base).inverse();
  }
  odometry_.clear();
  return T_old_new;
}

std::optional<LevelScan> LevelScanInput::add_scan(const scan::Scan& scan) {
  if (!scan::is_plausible(scan)) {
    ++counts_.implausible;
    return std::nullopt;
  }
  const scan::Scan* level = selector_.add(scan);
  if (level == nullptr) {
    ++counts_.not_level;
    return std::nullopt;
  }
  const auto T_odom_first = odometry_.at(level->stamp);
  if (!T_odom_first) {
    ++counts_.without_odometry;
    return std::nullopt;
  }
  const auto T_odom_last = odometry_.at(level->last_stamp()).value_or(*T_odom_first);
  const geometry::SE2 T_odom_base = geometry::to_se2(*T_odom_first);
  const geometry::SE2 T_first_last = T_odom_base.inverse() * geometry::to_se2(T_odom_last);
  return LevelScan{.stamp = level->stamp,
                   .T_odom_base = T_odom_base,
                   .sensor_origin_base = scan::point_in_base(*level, 0, 0.0).head<2>(),
                   .points_base = extractor_.extract(*level, T_first_last),
                   .odometry_gap_s = std::exchange(odometry_gap_s_, 0.0),
                   .is_of_nod = !is_stationary(*level)};
}

}  // namespace nodmap::slam2d
