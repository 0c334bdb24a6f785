// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/level_scan_input.hpp"

#include <algorithm>
#include <utility>

namespace nodmap::slam2d {

void LevelScanInput::add_odometry(time::Timestamp stamp, const geometry::SE3& T_published_base,
                                  bool has_restarted) {
  if (!T_published_base.matrix().allFinite()) {
    return;
  }
  const auto before = has_restarted ? odometry_.newest() : std::nullopt;
  if (has_restarted) {
    odometry_.clear();
    odometry_has_restarted_ = true;
  }
  if (!odometry_.add(stamp, T_published_base)) {
    return;
  }
  if (before) {
    T_odom_published_ = T_odom_published_ * geometry::to_se2(*before) *
                        geometry::to_se2(T_published_base).inverse();
  }
  odometry_gap_s_ =
      std::max(odometry_gap_s_, time::seconds(stamp - odometry_stamp_.value_or(stamp)));
  odometry_stamp_ = stamp;
}

std::optional<LevelScan> LevelScanInput::add_scan(const scan::Scan& scan) {
  if (!scan::is_plausible(scan)) {
    return std::nullopt;
  }
  const scan::Scan* level = selector_.add(scan);
  if (level == nullptr) {
    ++counts_.not_level;
    return std::nullopt;
  }
  const auto T_published_first = odometry_.at(level->stamp);
  if (!T_published_first) {
    ++counts_.without_odometry;
    return std::nullopt;
  }
  const geometry::SE2 T_published_base = geometry::to_se2(*T_published_first);
  const geometry::SE2 T_published_last =
      geometry::to_se2(odometry_.at(level->last_stamp()).value_or(*T_published_first));
  return LevelScan{
      .stamp = level->stamp,
      .T_odom_base = T_odom_published_ * T_published_base,
      .sensor_origin_base = scan::point_in_base(*level, 0, 0.0).head<2>(),
      .points_base = extractor_.extract(*level, T_published_base.inverse() * T_published_last),
      .odometry_gap_s = std::exchange(odometry_gap_s_, 0.0),
      .odometry_has_restarted = std::exchange(odometry_has_restarted_, false),
      .is_of_nod = !has_constant_pitch(*level)};
}

}  // namespace nodmap::slam2d
