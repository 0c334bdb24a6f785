// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/pose_history.hpp"
#include "modules/slam2d/back_end.hpp"
#include "modules/slam2d/level_scan_selector.hpp"
#include "modules/slam2d/occupancy_grid.hpp"
#include "modules/slam2d/oriented_points.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/point_map.hpp"
#include "modules/slam2d/pose_search.hpp"
#include "modules/slam2d/scan_matcher.hpp"

namespace nodmap::slam2d {

/// How a pose was found; the values of nodmap.pose_t.
enum class PoseQuality : std::uint8_t {
  kTracked = 0,   ///< by matching
  kPartly = 1,    ///< by matching, and by odometry along degenerate directions
  kOdometry = 2,  ///< by odometry: the scan has too few points
  kLost = 3,      ///< by odometry: the scan does not fit the map
};

/// The robot's pose at the first beam of a level scan.
struct PoseUpdate {
  std::int64_t utime_us = 0;  ///< of the first beam
  geometry::SE2 T_map_base = {};
  geometry::SE2 T_map_odom = {};  ///< the correction of odometry, which itself never jumps
  double inlier_ratio = 0.0;      ///< of the match, as the next two; 0 where there was none
  double score = 0.0;
  double rms_m = 0.0;
  PoseQuality quality = PoseQuality::kOdometry;
  bool is_keyframe = false;
};

/// Draws the rays of a keyframe, seen from a pose in the map.
void draw(const Keyframe& keyframe, const geometry::SE2& T_map_base, OccupancyGrid& grid);

/// Takes back what draw() has drawn from the same pose.
void erase(const Keyframe& keyframe, const geometry::SE2& T_map_base, OccupancyGrid& grid);

/// A level scan, relative to the keyframe before it, with which its pose is corrected.
struct TrackedScan {
  std::int64_t utime_us = 0;
  std::size_t keyframe = 0;  ///< index
  geometry::SE2 T_keyframe_base;
  geometry::SE2 T_map_base_online;  ///< as it was known when the scan came
};

struct Metrics {
  std::int64_t scans = 0;  ///< level scans with a pose: the sum of the next four
  std::int64_t tracked = 0;
  std::int64_t partly = 0;
  std::int64_t odometry_only = 0;
  std::int64_t lost = 0;
  std::int64_t searches = 0;
  std::int64_t searches_successful = 0;
  std::int64_t scans_implausible = 0;
  std::int64_t scans_not_level = 0;
  std::int64_t scans_without_odometry = 0;
  std::int64_t scans_without_points = 0;  ///< too few to begin a map
  double inlier_ratio_sum = 0.0;          ///< over `scans`
  double score_sum = 0.0;                 ///< over `scans`
};

/// 3DOF-SLAM (section IV A): level scans are matched against an incrementally built point map, and
/// what is new in them is added to it. That map is a submap; the back end joins the submaps and
/// closes loops between them. The map frame is the odom frame of the first scan.
class Slam2d {
 public:
  explicit Slam2d(const Slam2dParams& params);

  /// Takes a pose of base by odometry. Returns false, and ignores it, when it is not finite.
  bool add_odometry(std::int64_t utime_us, const geometry::SE3& T_odom_base);

  /// Odometry continues in another frame, because its publisher was restarted: its newest pose and
  /// `T_new_odom_base` are taken as the same place. The robot stays where it was in the map. Older
  /// odometry is dropped, so that no scan is placed between the two frames.
  void change_odometry_frame(const geometry::SE3& T_new_odom_base);

  /// Takes the next scan of a nodding or level scanner. Returns the corrected pose when it
  /// completes a level scan; that is this scan or the one before. Returns nothing, and counts why
  /// in metrics(), for a scan that is not level, implausible, more than 50 ms from any odometry, or
  /// the first and without points.
  std::optional<PoseUpdate> add_scan(const scan::Scan& scan);

  /// The pose of each of tracked_scans(), corrected by all that is known now.
  [[nodiscard]] std::vector<geometry::SE2> trajectory() const;

  /// Corrects all poses once more by all that is known; to be called after the last scan.
  void polish() { back_end_.polish(); }

  /// The submap that scans are matched against.
  [[nodiscard]] const PointMap& map() const { return back_end_.local().points; }
  [[nodiscard]] const BackEnd& back_end() const { return back_end_; }
  [[nodiscard]] std::span<const Keyframe> keyframes() const { return back_end_.keyframes(); }
  [[nodiscard]] std::span<const TrackedScan> tracked_scans() const { return tracked_scans_; }
  [[nodiscard]] const Metrics& metrics() const { return metrics_; }

 private:
  /// A level scan as the data set D of Eq. 3, and where the robot was by odometry.
  struct LevelScan {
    std::int64_t utime_us = 0;
    geometry::SE2 T_odom_base;
    Eigen::Vector2d sensor_origin_base = Eigen::Vector2d::Zero();
    std::span<const OrientedPoint> points_base;

    [[nodiscard]] bool has_enough_points() const;
  };

  [[nodiscard]] std::optional<LevelScan> next_level_scan(const scan::Scan& scan);
  [[nodiscard]] std::optional<PoseUpdate> begin_map(const LevelScan& scan);
  [[nodiscard]] Match match_or_search(const LevelScan& scan);
  [[nodiscard]] PoseUpdate correct_pose(const LevelScan& scan, const Match& match) const;
  [[nodiscard]] PoseQuality classify(const LevelScan& scan, const Match& match) const;
  [[nodiscard]] bool is_keyframe(const PoseUpdate& update, const geometry::SE2& T_odom_base) const;
  [[nodiscard]] bool has_moved(const geometry::SE2& T_odom_before,
                               const geometry::SE2& T_odom_now) const;
  void add_keyframe(const LevelScan& scan, const Match& match, PoseUpdate& update);
  void correct_odometry(const LevelScan& scan, PoseUpdate& update);
  void record(const PoseUpdate& update);

  Slam2dParams params_;
  LevelScanSelector selector_;
  geometry::PoseHistory odometry_;
  OrientedPointExtractor extractor_;
  ScanMatcher matcher_;
  PoseSearch search_;
  BackEnd back_end_;
  geometry::SE2 T_map_odom_;
  geometry::SE2 T_odom_keyframe_;  // the last one, in the present odom frame
  std::optional<geometry::SE2> T_odom_failed_search_;
  std::vector<TrackedScan> tracked_scans_;
  Metrics metrics_;
};

}  // namespace nodmap::slam2d
