// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <boost/circular_buffer.hpp>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/pose_history.hpp"
#include "common/geometry/se2.hpp"
#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "common/scan/scan.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/scan/level_scan.hpp"
#include "modules/slam2d/scan/level_scan_selector.hpp"
#include "modules/slam2d/scan/oriented_points.hpp"
#include "modules/slam2d/scan/sloped_points.hpp"
#include "modules/slam2d/scan/sweep_scan.hpp"
#include "modules/slam2d/scan/walls_behind.hpp"

namespace nodmap::slam2d {

/// Rejected scans, by cause.
struct ScanCounts {
  std::int64_t not_level = 0;
  std::int64_t without_odometry = 0;
};

/// Turns odometry and the scans of a nodding or level scanner into level scans. "... extracting
/// exactly those 2D scans that have been taken in the horizontal position" (section IV A).
class LevelScanInput {
 public:
  explicit LevelScanInput(const LevelScanParams& params)
      : selector_(params), leaves_out_slopes_(params.leave_out_slopes) {}

  /// Takes a pose of base by odometry; ignores it when it is not finite.
  ///
  /// `has_restarted`: this pose is the first in another frame, because the publisher of odometry
  /// was restarted. It is taken as the same place as the newest pose before, so the robot stays
  /// where it was. Older odometry is dropped: no scan is placed between the two frames. `lost`: how
  /// much of the time since the pose before was published, but did not arrive.
  void add_odometry(time::Timestamp stamp, const geometry::SE3& T_published_base,
                    bool has_restarted = false, time::Duration lost = {});

  /// Takes the next scan. It completes a level scan, which is this scan or the previous one, or is
  /// counted as not level. Ignores one that is implausible, which SensorInput counts.
  void add_scan(const scan::Scan& scan);

  /// The next level scan; valid until the next call. To be called after add_scan() until it returns
  /// none. A level scan waits until odometry has come as far, for at most half a second. One that
  /// is more than 50 ms from any odometry then, and not between two poses at most a second apart,
  /// is left out and counted. In a sweep that goes down a level scan also waits for the next two
  /// scans, until one comes that is 50 ms later.
  [[nodiscard]] std::optional<LevelScan> next();

  /// The level scan of points that were measured at once, in base and in the order of their
  /// directions from it: a virtual scan. Valid until the next call. Empty, and counted, if it is
  /// more than 50 ms from any odometry.
  [[nodiscard]] std::optional<LevelScan> add_virtual_scan(
      time::Timestamp stamp, std::span<const Eigen::Vector2d> points_base);

  /// No scan comes any more: what still waits does not wait for scans below it.
  void end_scans();

  /// Leaves out and counts the level scans that still wait: no odometry comes for them.
  void stop_waiting();

  /// Whether the last level scan was left out for lack of odometry.
  [[nodiscard]] bool lacks_odometry() const { return lacks_odometry_; }

  /// The frame of the odometry that is published now, in that of LevelScan::T_odom_base.
  [[nodiscard]] const geometry::SE2& T_odom_published() const { return T_odom_published_; }
  [[nodiscard]] const ScanCounts& counts() const { return counts_; }

 private:
  /// A time whose motion only odometry has counted; see LevelScan.
  struct Unseen {
    time::Timestamp since{};
    time::Duration duration{};
  };
  /// A level scan and, if it is to be compared with them, the two scans below it in its sweep: they
  /// came before it, or are still to come.
  struct Waiting {
    scan::Scan level;
    std::vector<scan::Scan> below = {};
    bool awaits_below = false;

    void take_below(const scan::Scan& scan);
  };
  [[nodiscard]] Waiting begin_waiting(const scan::Scan& level) const;
  [[nodiscard]] bool is_ready(const Waiting& waiting) const;
  [[nodiscard]] std::optional<LevelScan> to_level_scan(const Waiting& waiting);
  /// The points of a level scan; instead of those on slopes the walls behind these, as far as they
  /// were seen.
  [[nodiscard]] std::span<const OrientedPoint> without_slopes(
      std::span<const OrientedPoint> points_base, const SweepScan& level,
      const std::vector<scan::Scan>& below, const geometry::SE2& T_published_level);
  /// The scan with the motion of base since the level scan began at `T_published_level`; nothing
  /// if there is no odometry for it.
  [[nodiscard]] std::optional<SweepScan> place(const scan::Scan& scan,
                                               const geometry::SE2& T_published_level) const;
  /// The published pose of base at a time; counts a scan for which there is none.
  [[nodiscard]] std::optional<geometry::SE2> find_odometry(time::Timestamp stamp);
  /// Takes the time of any scan, and looks whether the robot has moved while scans were missing.
  void see(time::Timestamp begin, time::Timestamp end);
  void add_unseen(const Unseen& unseen);
  /// A level scan without points.
  [[nodiscard]] LevelScan begin_level_scan(time::Timestamp stamp,
                                           const geometry::SE2& T_published_base);

  LevelScanSelector selector_;
  bool leaves_out_slopes_;
  std::deque<Waiting> waiting_;                           // for odometry or for scans below
  time::Timestamp newest_scan_{};                         // the end of the last one, level or not
  std::optional<geometry::SE3> T_published_newest_scan_;  // the newest odometry then
  boost::circular_buffer<time::Duration> scan_gaps_{8};   // before the last scans
  bool lacks_odometry_ = false;
  geometry::PoseHistory odometry_;  // as published, since the last restart
  geometry::SE2 T_odom_published_;
  std::optional<time::Timestamp> odometry_stamp_;  // the newest
  double odometry_gap_s_ = 0.0;                    // the longest since the last level scan
  Unseen unseen_;                                  // the same
  bool odometry_has_restarted_ = false;            // since then
  OrientedPointExtractor extractor_;
  SlopedPoints sloped_points_;
  WallsBehind walls_behind_;
  std::vector<Eigen::Vector2d> positions_;  // with the walls behind slopes
  ScanCounts counts_;
};

}  // namespace nodmap::slam2d
