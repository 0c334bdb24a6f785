// SPDX-License-Identifier: BSD-3-Clause
#include "modules/map_server/map_server.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::map_server {

MapServer::MapServer(const MapServerParams& params)
    : body_(params.robot.body.footprint()),
      obstacle_map_(make_obstacle_map(params)),
      structure_map_(make_structure_map(params)),
      sweeps_(params.noise.pitch_sigma_rad) {}

ScanStatus MapServer::add_scan(const scan::Scan& scan, const geometry::SE3& T_odom_base) {
  if (!scan::is_plausible(scan) || scan.ranges_m.empty()) {
    return ScanStatus::kImplausibleScan;
  }
  if (!T_odom_base.matrix().allFinite()) {
    return ScanStatus::kImplausiblePose;
  }
  const auto T_now_last = pose_shift(geometry::to_se2(T_odom_base));
  const NewScan new_scan = new_scan_of(scan, advance_clock(scan.mid_stamp()));
  obstacle_map_.update(T_now_last, new_scan);
  structure_map_.update(T_now_last, new_scan);
  return ScanStatus::kUsed;
}

void MapServer::reset() {
  obstacle_map_.clear();
  structure_map_.clear();
  T_odom_last_.reset();
  last_stamp_.reset();
}

// Returns the motion since the last update; empty if it is below 1e-6. Small motions are not lost,
// because the reference pose stays the same until they add up.
std::optional<geometry::SE2> MapServer::pose_shift(const geometry::SE2& T_odom_base) {
  constexpr double kStationary = 1e-6;  // metres, radians
  if (!T_odom_last_) {
    T_odom_last_ = T_odom_base;
    return std::nullopt;
  }
  const geometry::SE2 T_now_last = T_odom_base.inverse() * *T_odom_last_;
  if (T_now_last.translation().norm() < kStationary && std::abs(T_now_last.yaw) < kStationary) {
    return std::nullopt;
  }
  T_odom_last_ = T_odom_base;
  return T_now_last;
}

double MapServer::advance_clock(time::Timestamp stamp) {
  const time::Duration elapsed = last_stamp_ ? std::max(0us, stamp - *last_stamp_) : 0us;
  last_stamp_ = stamp;
  clock_s_ += time::seconds(elapsed);
  return time::seconds(elapsed);
}

NewScan MapServer::new_scan_of(const scan::Scan& scan, double elapsed_s) {
  sweeps_.add(scan.pitch_first_rad, scan.pitch_last_rad);
  project(scan);
  NewScan new_scan{.hits = hits_,
                   .line = ScanLine(scan),
                   .sweep = sweeps_.sweep(),
                   .lowest_plane = std::nullopt,
                   .highest_plane = std::nullopt,
                   .elapsed_s = elapsed_s,
                   .clock_s = clock_s_};
  if (const auto covered = sweeps_.covered()) {
    new_scan.lowest_plane = laser_plane(scan, covered->min_rad);
    new_scan.highest_plane = laser_plane(scan, covered->max_rad);
  }
  return new_scan;
}

// Computes the point of each beam (Eq. 1) and its bin, by the bearing from the BASE: at a pitch of
// -60 degrees the beam's angle at the mirror differs from it by up to 19 degrees. Points inside the
// robot's body are dropped, because the scanner measures its own mount when it looks far down.
void MapServer::project(const scan::Scan& scan) {
  hits_.clear();
  hits_.reserve(scan.ranges_m.size());
  const AngleBins& bins = obstacle_map_.scan().bins();
  for (const auto& [p_base, beam] : projector_.hits(scan)) {
    Hit hit{EgoPoint::at(p_base.head<2>(), p_base.z()), 0};
    hit.point.confirmed_at_s = clock_s_;
    const auto bin = bins.index(hit.point.bearing_rad);
    if (bin && !body_.contains(hit.point.p_base)) {
      hit.bin = *bin;
      hits_.push_back(hit);
    }
  }
}

}  // namespace nodmap::map_server
