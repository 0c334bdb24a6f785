// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "modules/slam2d/back_end/back_end.hpp"
#include "modules/slam2d/back_end/tracked_path.hpp"
#include "modules/slam2d/executor.hpp"
#include "modules/slam2d/front_end/doubt.hpp"
#include "modules/slam2d/front_end/moving_points.hpp"
#include "modules/slam2d/front_end/place_search.hpp"
#include "modules/slam2d/front_end/pose_covariance.hpp"
#include "modules/slam2d/front_end/pose_finder.hpp"
#include "modules/slam2d/front_end/pose_guesses.hpp"
#include "modules/slam2d/front_end/slip_detector.hpp"
#include "modules/slam2d/localise/known_map.hpp"
#include "modules/slam2d/localise/localiser.hpp"
#include "modules/slam2d/matching/point_map.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/pose_update.hpp"
#include "modules/slam2d/scan/level_scan.hpp"
#include "modules/slam2d/scan/oriented_points.hpp"

namespace nodmap::slam2d {

struct Metrics {
  ScansByState scans;
  SearchCounts searches;          ///< in the saved map and, later on, in the local submap
  double inlier_ratio_sum = 0.0;  ///< over all `scans`
  double score_sum = 0.0;         ///< over all `scans`
};

/// 2D SLAM, the paper's 3DOF SLAM (section IV A): level scans are matched against an incrementally
/// built point map, and what is new in them is added to it. That map is a submap; the back end
/// joins the submaps and closes loops between them. The map frame is the odom frame of the first
/// scan, or that of the saved map that is continued. Level scans come from a LevelScanInput.
class Slam2d {
 public:
  /// `executor`: closes the loops after each keyframe. They are applied at a scan that the stamps
  /// alone determine, so that when and where it runs changes no pose.
  explicit Slam2d(const Slam2dParams& params,
                  std::unique_ptr<Executor> executor = std::make_unique<ImmediateExecutor>());
  Slam2d(const Slam2d&) = delete;  // its parts refer to each other
  Slam2d& operator=(const Slam2d&) = delete;

  /// Restores a saved map, to be continued. Must be called before the first scan. First the robot
  /// is found in `known`, the grid of that map, from `T_map_start` or by a search. Until its place
  /// is confirmed nothing is added.
  void restore(SavedMap map, TrinaryGrid known, const std::optional<geometry::SE2>& T_map_start);
  /// Whether there is a saved map in which the robot has not been found yet.
  [[nodiscard]] bool is_finding() const { return finder_ != nullptr; }
  /// The number of keyframes that come from the saved map. They are the first ones.
  [[nodiscard]] std::size_t num_restored() const { return num_restored_; }

  /// Takes the next level scan. Returns the corrected pose, or nothing if there is no map yet and
  /// the scan has too few points to begin one.
  std::optional<PoseUpdate> add_scan(const LevelScan& scan);

  /// The pose of each of tracked_scans(), with all corrections known so far.
  [[nodiscard]] std::vector<geometry::SE2> trajectory() const { return path_.poses(keyframes()); }

  /// Waits for the loops of the newest keyframe, if they are not applied yet, and applies them. To
  /// be called after the last scan.
  void finish_loops();

  /// Corrects all poses once more, with everything that is known. To be called after
  /// finish_loops().
  void polish() { back_end_.polish(); }

  [[nodiscard]] const BackEnd& back_end() const { return back_end_; }
  [[nodiscard]] std::span<const Keyframe> keyframes() const { return back_end_.keyframes(); }
  /// What the last add_scan() or finish_loops() has dropped from keyframes(), before a keyframe was
  /// added; null if nothing.
  [[nodiscard]] const DroppedKeyframes* dropped_keyframes() const;
  /// The scans with a pose, without those during which the robot was being found in a saved map.
  [[nodiscard]] std::span<const TrackedScan> tracked_scans() const { return path_.scans(); }
  [[nodiscard]] Metrics metrics() const;

 private:
  /// Finds the robot in a saved map.
  struct Finder {
    Finder(const Slam2dParams& params, TrinaryGrid grid,
           const std::optional<geometry::SE2>& T_map_start)
        : map(std::move(grid), params.map), localiser(params, map, T_map_start) {}
    KnownMap map;
    Localiser localiser;  // refers to `map`
  };

  [[nodiscard]] PoseUpdate find_in_saved_map(const LevelScan& scan);
  [[nodiscard]] std::optional<PoseUpdate> begin_new_map(const LevelScan& scan);
  void begin_at(const LevelScan& scan, PoseUpdate& update);
  void predict(const LevelScan& scan);
  void handle_odometry_gap(const LevelScan& scan);
  [[nodiscard]] SlipFinding check_slip(const LevelScan& scan);
  void remove_slip(const geometry::SE2& T_map_base, const geometry::SE2& T_odom_base);
  [[nodiscard]] StartPoses choose_start(const LevelScan& scan, const SlipFinding& slip) const;
  [[nodiscard]] PoseUpdate correct_pose(const LevelScan& scan, const FoundPose& found);
  [[nodiscard]] Eigen::Matrix3d estimate_covariance(const MatchedPose& pose,
                                                    const PoseUpdate& update);
  [[nodiscard]] PoseState classify(const LevelScan& scan, const FoundPose& found) const;
  [[nodiscard]] bool is_lost(const LevelScan& scan) const;
  [[nodiscard]] bool is_keyframe(const PoseUpdate& update, const LevelScan& scan,
                                 const FoundPose& found) const;
  [[nodiscard]] bool continues_in_doubt(const PoseUpdate& update,
                                        const geometry::SE2& T_odom_base) const;
  void record_motion(const LevelScan& scan, const PoseUpdate& update);
  [[nodiscard]] bool are_loops_due(const LevelScan& scan) const;
  geometry::SE2 apply_loops();
  void begin_submap_if_in_doubt();
  void add_keyframe(const LevelScan& scan, const Match& match, PoseUpdate& update);
  void update_map_odom(const LevelScan& scan, PoseUpdate& update);
  void count(const PoseUpdate& update);

  Slam2dParams params_;
  MovingPointFilter moving_points_;
  PoseGuesses pose_guesses_;
  BackEnd back_end_;
  geometry::SE2 T_map_odom_;
  PoseCovariance pose_covariance_;  // relative to the local submap, in the axes of map
  geometry::SE2 T_odom_last_;       // of the last level scan
  geometry::SE2 T_odom_keyframe_;   // of the last keyframe
  geometry::SE2 T_first_odom_;      // the odom frame in that of the first keyframe
  Doubt doubt_;
  SlipDetector slip_detector_;
  PlaceSearch place_search_;
  PoseFinder pose_finder_;
  TrackedPath path_;
  std::unique_ptr<Finder> finder_;                // until the robot is found; null for a new map
  std::size_t num_restored_ = 0;                  // the first keyframes
  Metrics metrics_;                               // the searches are those of the finder
  std::optional<time::Timestamp> closing_since_;  // loops of the keyframe with this stamp
  bool has_applied_loops_ = false;                // since the last scan
  std::unique_ptr<Executor> executor_;            // the last member: its work uses `back_end_`
};

}  // namespace nodmap::slam2d
