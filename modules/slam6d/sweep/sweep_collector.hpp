// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "common/geometry/pose_history.hpp"
#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "common/scan/scan.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"
#include "modules/slam6d/sweep/sweep_segmenter.hpp"

namespace nodmap::slam6d {

/// Counts of the scans of complete sweeps.
struct ScanCounts {
  std::size_t in_sweeps = 0;
  std::size_t without_pose = 0;  ///< of these, left out for lack of odometry
};

/// Collects the scans of a sweep, each with the pose of the robot by odometry.
class SweepCollector {
 public:
  /// `assume_stationary`: without any odometry the robot is taken as stationary.
  SweepCollector(const SweepParams& params, bool assume_stationary);

  /// Adds a pose of the robot by odometry. Returns false, and ignores it, if it is not finite.
  bool add_odometry(time::Timestamp stamp, const geometry::SE3& T_odom_base) {
    return odometry_.add(stamp, T_odom_base);
  }

  /// Continues with odometry in another frame; older poses are forgotten. Returns the new frame in
  /// the old one, chosen so that the robot stays where it was. Empty without odometry.
  std::optional<geometry::SE3> change_odometry_frame(const geometry::SE3& T_new_odom_base);

  /// Adds the next scan of the stream. Returns the sweep that it completes, if it completes one and
  /// there was odometry for it. A complete sweep waits until odometry has come as far as its end,
  /// for at most half a second; then it is returned with a later scan.
  [[nodiscard]] std::optional<PlacedSweep> add_scan(scan::Scan scan);

  /// At the end of the stream: the next of the sweeps that wait for odometry, at last the
  /// unfinished one. Empty once none is left that there was odometry for.
  [[nodiscard]] std::optional<PlacedSweep> flush();

  [[nodiscard]] const ScanCounts& counts() const { return counts_; }

 private:
  [[nodiscard]] std::optional<PlacedSweep> place_oldest();

  bool assume_stationary_;
  SweepSegmenter segmenter_;
  geometry::PoseHistory odometry_;
  std::deque<Sweep> waiting_;    // complete, but odometry has not come as far yet
  bool is_interrupted_ = false;  // since the last sweep that could be placed
  ScanCounts counts_;
};

}  // namespace nodmap::slam6d
