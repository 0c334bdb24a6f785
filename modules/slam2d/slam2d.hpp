// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "modules/slam2d/back_end.hpp"
#include "modules/slam2d/occupancy_grid.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/point_map.hpp"
#include "modules/slam2d/pose_search.hpp"
#include "modules/slam2d/scan_matcher.hpp"
#include "modules/slam2d/scan_surface.hpp"

namespace nodmap::slam2d {

/// How a pose was found; the values of nodmap.pose_t.
enum class PoseQuality : std::uint8_t { kTracked = 0, kPartly = 1, kOdometry = 2, kLost = 3 };

struct Slam2dResult {
  std::int64_t utime_us = 0;
  geometry::SE2 T_map_base;
  geometry::SE2 T_map_odom;  ///< carries the whole correction: odom itself never jumps
  double match_share = 0.0;
  double match_agreement = 0.0;
  double match_rms_m = 0.0;
  PoseQuality quality = PoseQuality::kOdometry;
  bool map_changed = false;
};

/// Draws the rays of a keyframe, seen from a pose in the map.
void draw(const Keyframe& keyframe, const geometry::SE2& T_map_base, OccupancyGrid& grid);

/// Takes them back.
void erase(const Keyframe& keyframe, const geometry::SE2& T_map_base, OccupancyGrid& grid);

/// A used scan, placed relative to its keyframe: it moves along when that is corrected.
struct TrackedScan {
  std::int64_t utime_us = 0;
  std::size_t keyframe = 0;
  geometry::SE2 T_keyframe_base;
  geometry::SE2 T_map_base_online;  ///< as it was known then
};

struct Slam2dFigures {
  std::int64_t scans = 0;
  std::int64_t tracked = 0;
  std::int64_t partly = 0;
  std::int64_t odometry_only = 0;
  std::int64_t lost = 0;
  std::int64_t searches = 0;
  std::int64_t searches_helped = 0;
  double share_sum = 0.0;
  double agreement_sum = 0.0;
};

/// 3DOF SLAM (section IV A): level scans are matched against an incrementally built point map; what
/// is new in them is added.
class Slam2d {
 public:
  explicit Slam2d(const Slam2dParams& params);

  /// Takes a level scan, where the robot was by odometry at its first beam, and how it moved from
  /// there to the last one; poses are those at the first beam. Empty when the scan is no plausible
  /// one or a pose is not finite, and when the first scan shows nothing to begin with.
  std::optional<Slam2dResult> add_scan(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                                       const geometry::SE2& T_first_last = {});

  /// Odometry goes on in another frame: the same place, as far as anybody knows, is
  /// `T_old_odom_base` in the present frame and `T_new_odom_base` in the new one. The robot stays
  /// where it was in the map.
  void change_odometry_frame(const geometry::SE2& T_old_odom_base,
                             const geometry::SE2& T_new_odom_base);

  /// Corrects all poses once more with all that is known; nothing is added after it.
  void polish() { back_end_.polish(); }

  /// The submap that scans are matched against.
  [[nodiscard]] const PointMap& map() const { return back_end_.local().points; }
  [[nodiscard]] const BackEnd& back_end() const { return back_end_; }
  [[nodiscard]] const std::vector<Keyframe>& keyframes() const { return back_end_.keyframes(); }
  [[nodiscard]] const std::vector<TrackedScan>& tracked_scans() const { return tracked_scans_; }
  [[nodiscard]] const Slam2dFigures& figures() const { return figures_; }

  /// The pose of a used scan with all that is known now.
  [[nodiscard]] geometry::SE2 corrected_pose(const TrackedScan& scan) const;

 private:
  [[nodiscard]] Match match_or_search(std::span<const SurfacePoint> points,
                                      const geometry::SE2& T_local_base_guess,
                                      const geometry::SE2& T_odom_base);
  [[nodiscard]] PoseQuality judge(const Match& match, std::size_t num_points) const;
  [[nodiscard]] bool is_due_for_map(const geometry::SE2& T_odom_base, PoseQuality quality) const;
  void add_keyframe(std::span<const SurfacePoint> points, const Slam2dResult& result,
                    const geometry::SE2& T_odom_base, const Eigen::Vector2d& eye_base,
                    const Eigen::Matrix3d& information);
  void record(const Slam2dResult& result);

  Slam2dParams params_;
  ScanSurface surface_;
  ScanMatcher matcher_;
  PoseSearch search_;
  BackEnd back_end_;
  geometry::SE2 T_map_odom_;
  geometry::SE2 T_odom_keyframe_;  // the last one, in the present odom frame
  std::optional<geometry::SE2> T_odom_failed_search_;
  std::vector<TrackedScan> tracked_scans_;
  Slam2dFigures figures_;
};

}  // namespace nodmap::slam2d
