// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/front_end/pose_finder.hpp"

#include "modules/slam2d/matching/best_place.hpp"

namespace nodmap::slam2d {
namespace {

// Whether most points of a scan lie in space that was free before: either people surround the
// robot or it is elsewhere.
bool is_mostly_moving(const LevelScan& stationary, const LevelScan& all_points) {
  return 2 * stationary.points_base.size() < all_points.points_base.size();
}

FoundPose by_odometry(const LevelScan& scan) {
  return {.pose = {}, .scan = scan, .is_hidden = true};
}

}  // namespace

LevelScan PoseFinder::without_moving_points(const LevelScan& all_points, const StartPoses& start) {
  LevelScan scan = all_points;
  if (start.is_by_odometry && !doubt_.is_active()) {
    scan.points_base = moving_points_.stationary(all_points);
  }
  return scan;
}

// Whether odometry goes on so smoothly that the robot cannot be elsewhere.
bool PoseFinder::is_smooth(const LevelScan& scan, const StartPoses& start) const {
  return start.guesses.size() == 1 && !doubt_.is_active() && pose_guesses_.is_fast(scan.stamp);
}

FoundPose PoseFinder::match_or_search(const LevelScan& all_points, const StartPoses& start) {
  LevelScan scan = without_moving_points(all_points, start);
  if (is_smooth(all_points, start)) {
    if (const auto pose = find_between_people(scan, all_points, start)) {
      hidden_view_.end();
      return {*pose, scan};
    }
    if (hidden_view_.wait(scan.stamp)) {
      return by_odometry(scan);
    }
  }
  if (is_mostly_moving(scan, all_points)) {
    scan = all_points;
  }
  const MatchedPose pose = place_search_.find(scan, all_points, start);
  // The level scans of a nodding laser are too far apart to give a speed. But whoever hides the
  // view from one of them has passed by the next, and the robot is not elsewhere meanwhile.
  if (all_points.is_of_nod && !doubt_.is_active() && !fits_by_odometry(pose.match, start) &&
      moving_points_.contradicts(all_points) && hidden_view_.wait(scan.stamp)) {
    return by_odometry(scan);
  }
  return {.pose = pose, .scan = scan, .odometry_was_wrong = hidden_view_.end()};
}

// People nearby may hide all but a few walls. The remaining points determine the pose if they fit
// well. A match of all points would follow the people: somebody who walks ahead of a stationary
// robot would shift its pose.
std::optional<MatchedPose> PoseFinder::find_between_people(const LevelScan& scan,
                                                           const LevelScan& all_points,
                                                           const StartPoses& start) {
  MatchedPose pose;
  if (!is_mostly_moving(scan, all_points)) {
    pose = place_search_.find(scan, all_points, start);
  } else if (scan.has_enough_to_search()) {
    pose.match = place_search_.match(scan, start);
    if (pose.match.score < doubt_params_.certain_score) {
      return std::nullopt;
    }
  } else {
    return std::nullopt;
  }
  const geometry::SE2& T_map_submap = back_end_.local().T_map_submap;
  const geometry::SE2& T_submap_base = pose.match.T_target_base;
  const bool is_odd =
      pose.match.found() && pose_guesses_.is_beyond_slip(scan, T_map_submap * start.guesses.front(),
                                                         T_map_submap * T_submap_base);
  return is_odd ? std::nullopt : std::optional(pose);
}

// Whether a scan fits, at the pose by odometry or beside it.
bool PoseFinder::fits_by_odometry(const Match& match, const StartPoses& start) const {
  return match.found() && match.score >= lost_params_.score_threshold &&
         is_same_place(match.T_target_base, start.guesses.front());
}

}  // namespace nodmap::slam2d
