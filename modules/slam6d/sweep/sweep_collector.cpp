// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/sweep/sweep_collector.hpp"

#include <utility>

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// Odometry is kept for the longest sweep, at 10 scans a second (the slowest device known).
time::Duration history_span(const SweepParams& params) {
  return 100ms * (params.max_scans + 1);
}

constexpr time::Duration kMaxExtrapolation = 50ms;

}  // namespace

SweepCollector::SweepCollector(const SweepParams& params, bool assume_stationary)
    : assume_stationary_(assume_stationary),
      segmenter_(params),
      odometry_(history_span(params), kMaxExtrapolation) {}

std::optional<SE3> SweepCollector::change_odometry_frame(const SE3& T_new_odom_base) {
  const auto T_old_odom_base = odometry_.newest();
  odometry_.clear();
  return T_old_odom_base ? std::optional<SE3>(*T_old_odom_base * T_new_odom_base.inverse())
                         : std::nullopt;
}

// IV B: "segment the continuous data flow to reflect one complete pitch movement per point cloud".
std::optional<PlacedSweep> SweepCollector::add_scan(scan::Scan scan) {
  const time::Timestamp now = scan.last_stamp();
  if (auto sweep = segmenter_.add(std::move(scan))) {
    waiting_.push_back(std::move(*sweep));
  }
  return waiting_.empty() || odometry_.is_awaited(waiting_.front().scans.back().last_stamp(), now)
             ? std::nullopt
             : place_oldest();
}

std::optional<PlacedSweep> SweepCollector::flush() {
  if (auto sweep = segmenter_.flush()) {
    waiting_.push_back(std::move(*sweep));
  }
  std::optional<PlacedSweep> placed;
  while (!placed && !waiting_.empty()) {
    placed = place_oldest();
  }
  return placed;
}

std::optional<PlacedSweep> SweepCollector::place_oldest() {
  Sweep sweep = std::move(waiting_.front());
  waiting_.pop_front();
  const auto pose_at = [this](time::Timestamp stamp) -> std::optional<SE3> {
    if (odometry_.empty() && assume_stationary_) {
      return SE3::Identity();
    }
    return odometry_.at(stamp);
  };
  const std::size_t num_scans = sweep.scans.size();
  counts_.in_sweeps += num_scans;
  is_interrupted_ = is_interrupted_ || sweep.follows_interruption;
  auto placed = place(std::move(sweep.scans), pose_at);
  if (!placed) {
    // As after a pause of the scans nobody has seen the robot move.
    counts_.without_pose += num_scans;
    is_interrupted_ = true;
    return std::nullopt;
  }
  counts_.without_pose += placed->scans_without_pose;
  placed->follows_interruption =
      std::exchange(is_interrupted_, false) || placed->scans_without_pose > 0;
  return placed;
}

}  // namespace nodmap::slam6d
