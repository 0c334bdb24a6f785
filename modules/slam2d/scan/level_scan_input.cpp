// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/level_scan_input.hpp"

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
    stop_waiting();
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

void LevelScanInput::add_scan(const scan::Scan& scan) {
  if (!scan::is_plausible(scan)) {
    return;
  }
  newest_scan_ = scan.last_stamp();
  if (const scan::Scan* level = selector_.add(scan)) {
    waiting_.push_back(*level);
  } else {
    ++counts_.not_level;
  }
}

std::optional<LevelScan> LevelScanInput::next() {
  std::optional<LevelScan> placed;
  while (!placed && !waiting_.empty() &&
         !odometry_.is_awaited(waiting_.front().last_stamp(), newest_scan_)) {
    placed = place(waiting_.front());
    waiting_.pop_front();
  }
  return placed;
}

void LevelScanInput::stop_waiting() {
  counts_.without_odometry += static_cast<std::int64_t>(waiting_.size());
  lacks_odometry_ = lacks_odometry_ || !waiting_.empty();
  waiting_.clear();
}

std::optional<LevelScan> LevelScanInput::place(const scan::Scan& scan) {
  const auto T_published_first = odometry_.at(scan.stamp);
  lacks_odometry_ = !T_published_first;
  if (lacks_odometry_) {
    ++counts_.without_odometry;
    return std::nullopt;
  }
  const geometry::SE2 T_published_base = geometry::to_se2(*T_published_first);
  const geometry::SE2 T_published_last =
      geometry::to_se2(odometry_.at(scan.last_stamp()).value_or(*T_published_first));
  return LevelScan{
      .stamp = scan.stamp,
      .T_odom_base = T_odom_published_ * T_published_base,
      .sensor_origin_base = scan::point_in_base(scan, 0, 0.0).head<2>(),
      .points_base = extractor_.extract(scan, T_published_base.inverse() * T_published_last),
      .odometry_gap_s = std::exchange(odometry_gap_s_, 0.0),
      .odometry_has_restarted = std::exchange(odometry_has_restarted_, false),
      .is_of_nod = !has_constant_pitch(scan)};
}

}  // namespace nodmap::slam2d
