// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "modules/slam2d/back_end.hpp"
#include "modules/slam2d/doubt.hpp"
#include "modules/slam2d/hidden_view.hpp"
#include "modules/slam2d/level_scan.hpp"
#include "modules/slam2d/moving_points.hpp"
#include "modules/slam2d/oriented_points.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/place_search.hpp"
#include "modules/slam2d/point_map.hpp"
#include "modules/slam2d/pose_covariance.hpp"
#include "modules/slam2d/pose_guesses.hpp"
#include "modules/slam2d/pose_update.hpp"
#include "modules/slam2d/tracked_path.hpp"

namespace nodmap::slam2d {

struct Metrics {
  ScansByState scans;
  double inlier_ratio_sum = 0.0;  ///< over all `scans`
  double score_sum = 0.0;         ///< over all `scans`
};

/// 3DOF-SLAM (section IV A): level scans are matched against an incrementally built point map, and
/// what is new in them is added to it. That map is a submap; the back end joins the submaps and
/// closes loops between them. The map frame is the odom frame of the first scan, or that of the
/// saved map. Level scans come from a LevelScanInput.
class Slam2d {
 public:
  explicit Slam2d(const Slam2dParams& params);

  /// Restores a saved map. Must be called before the first scan, and followed by begin_at(), which
  /// says where the next level scan is added.
  void restore(SavedMap map) { back_end_.restore(std::move(map)); }

  /// Sets T_map_odom, as found by a Localiser in the saved map. Odometry then counts as begun in
  /// map.
  void begin_at(const geometry::SE2& T_map_odom) {
    T_map_odom_ = T_map_odom;
    T_first_odom_ = T_map_odom;
  }

  /// Takes the next level scan. Returns the corrected pose, or nothing if there is no map yet and
  /// the scan has too few points to begin one.
  std::optional<PoseUpdate> add_scan(const LevelScan& scan);

  /// The pose of each of tracked_scans(), with all corrections known so far.
  [[nodiscard]] std::vector<geometry::SE2> trajectory() const { return path_.poses(keyframes()); }

  /// Corrects all poses once more, with everything that is known. To be called after the last scan.
  void polish() { back_end_.polish(); }

  /// The submap that scans are matched against. There is one as soon as a scan has a pose.
  [[nodiscard]] const PointMap& map() const { return back_end_.local().points; }
  [[nodiscard]] const BackEnd& back_end() const { return back_end_; }
  [[nodiscard]] std::span<const Keyframe> keyframes() const { return back_end_.keyframes(); }
  /// What the last scan that became a keyframe has dropped from keyframes().
  [[nodiscard]] const std::optional<DroppedKeyframes>& dropped_keyframes() const {
    return back_end_.dropped();
  }
  [[nodiscard]] std::span<const TrackedScan> tracked_scans() const { return path_.scans(); }
  [[nodiscard]] const Metrics& metrics() const { return metrics_; }
  [[nodiscard]] const PlaceSearch::Counts& search_counts() const { return place_search_.counts(); }

 private:
  [[nodiscard]] std::optional<PoseUpdate> begin_map(const LevelScan& scan);
  void follow_odometry(const LevelScan& scan);
  [[nodiscard]] Start choose_start(const LevelScan& scan) const;
  [[nodiscard]] FoundPlace find_place(const LevelScan& scan);
  [[nodiscard]] PoseUpdate correct_pose(const LevelScan& scan, const FoundPlace& found);
  [[nodiscard]] Eigen::Matrix3d estimate_covariance(const Place& place, const PoseUpdate& update);
  [[nodiscard]] PoseState classify(const LevelScan& scan, const FoundPlace& found) const;
  [[nodiscard]] bool is_lost(const LevelScan& scan) const;
  [[nodiscard]] bool is_keyframe(const PoseUpdate& update, const LevelScan& scan,
                                 const FoundPlace& found) const;
  [[nodiscard]] bool continues_in_doubt(const PoseUpdate& update,
                                        const geometry::SE2& T_odom_base) const;
  void record_motion(const LevelScan& scan, const PoseUpdate& update);
  void begin_submap_if_in_doubt();
  void add_keyframe(const LevelScan& scan, const Match& match, PoseUpdate& update);
  void correct_odometry(const LevelScan& scan, PoseUpdate& update);
  void record(const PoseUpdate& update);

  Slam2dParams params_;
  MovingPointFilter moving_points_;
  PoseGuesses pose_guesses_;
  PlaceSearch place_search_;
  BackEnd back_end_;
  geometry::SE2 T_map_odom_;
  PoseCovariance pose_covariance_;  // relative to the local submap, in the axes of map
  geometry::SE2 T_odom_last_;       // of the last level scan
  geometry::SE2 T_odom_keyframe_;   // of the last keyframe
  geometry::SE2 T_first_odom_;      // the odom frame in that of the first keyframe
  Doubt doubt_;
  HiddenView hidden_view_;
  TrackedPath path_;
  Metrics metrics_;
};

}  // namespace nodmap::slam2d
