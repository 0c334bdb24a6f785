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
  std::optional<LevelScan> level_scan;
  while (!level_scan && !waiting_.empty() &&
         !odometry_.is_awaited(waiting_.front().last_stamp(), newest_scan_)) {
    level_scan = to_level_scan(waiting_.front());
    waiting_.pop_front();
  }
  return level_scan;
}

void LevelScanInput::stop_waiting() {
  counts_.without_odometry += static_cast<std::int64_t>(waiting_.size());
  lacks_odometry_ = lacks_odometry_ || !waiting_.empty();
  waiting_.clear();
}

std::optional<geometry::SE2> LevelScanInput::find_odometry(time::Timestamp stamp) {
  const auto T_published_base = odometry_.at(stamp);
  lacks_odometry_ = !T_published_base;
  if (lacks_odometry_) {
    ++counts_.without_odometry;
    return std::nullopt;
  }
  return geometry::to_se2(*T_published_base);
}

LevelScan LevelScanInput::begin_level_scan(time::Timestamp stamp,
                                           const geometry::SE2& T_published_base) {
  LevelScan level_scan;
  level_scan.stamp = stamp;
  level_scan.T_odom_base = T_odom_published_ * T_published_base;
  level_scan.odometry_gap_s = std::exchange(odometry_gap_s_, 0.0);
  level_scan.odometry_has_restarted = std::exchange(odometry_has_restarted_, false);
  return level_scan;
}

std::optional<LevelScan> LevelScanInput::to_level_scan(const scan::Scan& scan) {
  const auto T_published_first = find_odometry(scan.stamp);
  if (!T_published_first) {
    return std::nullopt;
  }
  const auto last = odometry_.at(scan.last_stamp());
  const geometry::SE2 T_published_last = last ? geometry::to_se2(*last) : *T_published_first;
  LevelScan level_scan = begin_level_scan(scan.stamp, *T_published_first);
  level_scan.sensor_origin_base = scan::point_in_base(scan, 0, 0.0).head<2>();
  level_scan.points_base =
      extractor_.extract(scan, T_published_first->inverse() * T_published_last);
  level_scan.is_of_nod = !has_constant_pitch(scan);
  return level_scan;
}

std::optional<LevelScan> LevelScanInput::add_virtual_scan(
    time::Timestamp stamp, std::span<const Eigen::Vector2d> points_base) {
  const auto T_published_base = find_odometry(stamp);
  if (!T_published_base) {
    return std::nullopt;
  }
  LevelScan level_scan = begin_level_scan(stamp, *T_published_base);
  level_scan.points_base = extractor_.extract(points_base, level_scan.sensor_origin_base);
  return level_scan;
}

}  // namespace nodmap::slam2d
