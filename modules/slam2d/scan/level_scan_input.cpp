// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/scan/level_scan_input.hpp"

#include <algorithm>
#include <utility>

#include "common/geometry/pose_tolerance.hpp"

namespace nodmap::slam2d {
namespace {

constexpr std::size_t kNumBelow = 2;  // what SlopedPoints compares a level scan with
// Two periods of a SICK (13.3 ms) and some jitter: scans that have not come by then are lost.
constexpr time::Duration kMaxWaitBelow = 50ms;
// Scans are missing after so many times the longest gap between the last ones: some recordings have
// few scans.
constexpr int kMissingScans = 4;
// While odometry moves by less, none are missing: some recordings have fewer of a stationary robot.
constexpr geometry::PoseTolerance kUnmoved{.distance_m = 0.5, .rotation_rad = 0.5};

}  // namespace

void LevelScanInput::add_odometry(time::Timestamp stamp, const geometry::SE3& T_published_base,
                                  bool has_restarted, time::Duration lost) {
  if (!T_published_base.matrix().allFinite()) {
    return;
  }
  const auto before = has_restarted ? odometry_.newest() : std::nullopt;
  if (has_restarted) {
    stop_waiting();
    odometry_.clear();
    T_published_newest_scan_.reset();
    odometry_has_restarted_ = true;
  }
  if (!odometry_.add(stamp, T_published_base)) {
    return;
  }
  if (before) {
    T_odom_published_ = T_odom_published_ * geometry::to_se2(*before) *
                        geometry::to_se2(T_published_base).inverse();
  }
  const time::Timestamp last = odometry_stamp_.value_or(stamp);
  odometry_gap_s_ = std::max(odometry_gap_s_, time::seconds(stamp - last - lost));
  add_unseen({last, lost});
  odometry_stamp_ = stamp;
}

void LevelScanInput::add_scan(const scan::Scan& scan) {
  if (!scan::is_plausible(scan)) {
    return;
  }
  see(scan.stamp, scan.last_stamp());
  if (leaves_out_slopes_ && !has_constant_pitch(scan)) {
    walls_behind_.add(scan);
  }
  for (Waiting& waiting : waiting_) {
    if (waiting.awaits_below) {
      waiting.take_below(scan);
    }
  }
  if (const scan::Scan* level = selector_.add(scan)) {
    waiting_.push_back(begin_waiting(*level));
  } else {
    ++counts_.not_level;
  }
}

void LevelScanInput::see(time::Timestamp begin, time::Timestamp end) {
  const std::optional<geometry::SE3> T_published_base = odometry_.newest();
  const time::Duration gap = begin - newest_scan_;
  const bool are_missing =
      scan_gaps_.full() && gap > kMissingScans * *std::ranges::max_element(scan_gaps_);
  if (are_missing && T_published_base && T_published_newest_scan_ &&
      !geometry::is_within(*T_published_newest_scan_, *T_published_base, kUnmoved)) {
    add_unseen({newest_scan_, gap});
  }
  scan_gaps_.push_back(gap);
  newest_scan_ = end;
  T_published_newest_scan_ = T_published_base;
}

void LevelScanInput::add_unseen(const Unseen& unseen) {
  if (unseen.duration > unseen_.duration) {
    unseen_ = unseen;
  }
}

void LevelScanInput::Waiting::take_below(const scan::Scan& scan) {
  below.push_back(scan);
  awaits_below = below.size() < kNumBelow;
}

// A sweep that goes up shows what is below the level scan before it, one that goes down after it.
LevelScanInput::Waiting LevelScanInput::begin_waiting(const scan::Scan& level) const {
  Waiting waiting{.level = level};
  const auto before = selector_.before();
  if (!leaves_out_slopes_ || before[0] == nullptr) {
    return waiting;
  }
  waiting.awaits_below = before[0]->pitch_mid_rad() > level.pitch_mid_rad();
  if (!waiting.awaits_below) {
    waiting.below = {*before[0], *before[1]};
  } else if (const scan::Scan* after = selector_.after()) {
    waiting.take_below(*after);
  }
  return waiting;
}

bool LevelScanInput::is_ready(const Waiting& waiting) const {
  const bool may_come = newest_scan_ - waiting.level.last_stamp() < kMaxWaitBelow;
  return !(waiting.awaits_below && may_come) &&
         !odometry_.is_awaited(waiting.level.last_stamp(), newest_scan_);
}

std::optional<LevelScan> LevelScanInput::next() {
  std::optional<LevelScan> level_scan;
  while (!level_scan && !waiting_.empty() && is_ready(waiting_.front())) {
    level_scan = to_level_scan(waiting_.front());
    waiting_.pop_front();
  }
  return level_scan;
}

void LevelScanInput::end_scans() {
  for (Waiting& waiting : waiting_) {
    waiting.awaits_below = false;
  }
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
  if (stamp > unseen_.since) {  // not one that waited meanwhile
    level_scan.unseen_s = time::seconds(std::exchange(unseen_, {}).duration);
  }
  level_scan.odometry_has_restarted = std::exchange(odometry_has_restarted_, false);
  return level_scan;
}

std::optional<LevelScan> LevelScanInput::to_level_scan(const Waiting& waiting) {
  const scan::Scan& scan = waiting.level;
  const auto T_published_first = find_odometry(scan.stamp);
  if (!T_published_first) {
    return std::nullopt;
  }
  const SweepScan placed = place(scan, *T_published_first).value_or(SweepScan{scan});
  LevelScan level_scan = begin_level_scan(scan.stamp, *T_published_first);
  level_scan.sensor_origin_base = scan::point_in_base(scan, 0, 0.0).head<2>();
  level_scan.points_base = extractor_.extract(scan, placed.T_level_last);
  level_scan.is_of_nod = !has_constant_pitch(scan);
  if (waiting.below.size() == kNumBelow) {
    level_scan.points_base =
        without_slopes(level_scan.points_base, placed, waiting.below, *T_published_first);
  }
  return level_scan;
}

std::optional<SweepScan> LevelScanInput::place(const scan::Scan& scan,
                                               const geometry::SE2& T_published_level) const {
  const auto first = odometry_.at(scan.stamp);
  const auto last = odometry_.at(scan.last_stamp());
  if (!first || !last) {
    return std::nullopt;
  }
  const geometry::SE2 T_level_published = T_published_level.inverse();
  return SweepScan{scan, T_level_published * geometry::to_se2(*first),
                   T_level_published * geometry::to_se2(*last)};
}

std::span<const OrientedPoint> LevelScanInput::without_slopes(
    std::span<const OrientedPoint> points_base, const SweepScan& level,
    const std::vector<scan::Scan>& below, const geometry::SE2& T_published_level) {
  const auto first = place(below.front(), T_published_level);
  const auto second = place(below.back(), T_published_level);
  if (!first || !second) {
    return points_base;
  }
  if (!sloped_points_.find(points_base, level, {*first, *second})) {
    return points_base;
  }
  const auto walls =
      walls_behind_.find(level.scan, sloped_points_.are_on_slopes(),
                         [&](const scan::Scan& scan) { return place(scan, T_published_level); });
  positions_.clear();
  for (std::size_t beam = 0; beam < walls.size(); ++beam) {
    if (walls[beam]) {
      positions_.push_back(*walls[beam]);
    } else if (const OrientedPoint* const other = sloped_points_.other_point(beam)) {
      positions_.push_back(other->p);
    }
  }
  return extractor_.extract(positions_, scan::point_in_base(level.scan, 0, 0.0).head<2>());
}

std::optional<LevelScan> LevelScanInput::add_virtual_scan(
    time::Timestamp stamp, std::span<const Eigen::Vector2d> points_base) {
  see(stamp, stamp);
  const auto T_published_base = find_odometry(stamp);
  if (!T_published_base) {
    return std::nullopt;
  }
  LevelScan level_scan = begin_level_scan(stamp, *T_published_base);
  level_scan.points_base = extractor_.extract(points_base, level_scan.sensor_origin_base);
  return level_scan;
}

}  // namespace nodmap::slam2d
