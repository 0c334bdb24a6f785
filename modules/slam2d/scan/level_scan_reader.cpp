// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/level_scan_reader.hpp"

#include "common/node/messages.hpp"

namespace nodmap::slam2d {

void LevelScanReader::read(const nodmap::odometry_t& message) {
  if (const auto T_odom_base = messages_.read(message)) {
    input_.add_odometry(node::stamp_of(message), *T_odom_base, messages_.odometry_restarted(),
                        messages_.odometry_lost());
    counts_.use();
  }
}

void LevelScanReader::read(const nodmap::scan_t& message) {
  if (messages_.read(message, scan_)) {
    scan_stamp_ = scan_.stamp;
    if (!uses_structure_map_) {
      input_.add_scan(scan_);
    }
  }
}

std::optional<LevelScan> LevelScanReader::read(const nodmap::egomap_t& message) {
  const time::Timestamp stamp = node::stamp_of(message);
  if (!uses_structure_map_ || !time::is_due(stamp, last_structure_map_, structure_period_)) {
    return std::nullopt;
  }
  const auto points_base = messages_.read(message);
  if (!points_base) {
    return std::nullopt;
  }
  last_structure_map_ = stamp;
  std::optional<LevelScan> level_scan = input_.add_virtual_scan(stamp, *points_base);
  reject_without_odometry();
  return level_scan;
}

std::optional<LevelScan> LevelScanReader::next() {
  std::optional<LevelScan> level_scan = input_.next();
  reject_without_odometry();
  return level_scan;
}

void LevelScanReader::finish() {
  input_.stop_waiting();
  reject_without_odometry();
}

void LevelScanReader::reject_without_odometry() {
  counts_.reject("scan_without_odometry", input_.counts().without_odometry - without_odometry_);
  without_odometry_ = input_.counts().without_odometry;
}

}  // namespace nodmap::slam2d
