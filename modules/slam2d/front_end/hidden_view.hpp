// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/time.hpp"
#include "modules/slam2d/back_end/back_end.hpp"
#include "modules/slam2d/front_end/doubt.hpp"
#include "modules/slam2d/front_end/moving_points.hpp"
#include "modules/slam2d/front_end/place_search.hpp"
#include "modules/slam2d/front_end/pose_guesses.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/scan/level_scan.hpp"

namespace nodmap::slam2d {

/// The place of a scan, and how it was found.
struct FoundPose {
  MatchedPose pose;
  LevelScan scan;            ///< without the points that have moved
  bool has_slipped = false;  ///< odometry, not people, has been wrong for a second
  bool is_hidden = false;    ///< people surround the robot: its pose is by odometry alone
};

/// The view that people hide. Finds the place of a scan from what they leave of it. Where that does
/// not tell the place, and the robot cannot be elsewhere, its pose is by odometry until people have
/// had time to pass.
class HiddenView {
 public:
  /// The parts that it uses must outlive it.
  HiddenView(const Slam2dParams& params, PlaceSearch& place_search, const BackEnd& back_end,
             MovingPointFilter& moving_points, const PoseGuesses& pose_guesses, const Doubt& doubt)
      : place_search_(place_search),
        back_end_(back_end),
        moving_points_(moving_points),
        pose_guesses_(pose_guesses),
        doubt_(doubt),
        people_params_(params.people),
        lost_params_(params.lost),
        doubt_params_(params.doubt) {}

  /// Finds the place of a scan; valid until the next call.
  [[nodiscard]] FoundPose find_pose(const LevelScan& all_points, const StartPoses& start);

 private:
  [[nodiscard]] LevelScan without_moving_points(const LevelScan& all_points,
                                                const StartPoses& start);
  [[nodiscard]] bool is_smooth(const LevelScan& scan, const StartPoses& start) const;
  [[nodiscard]] std::optional<MatchedPose> find_between_people(const LevelScan& scan,
                                                               const LevelScan& all_points,
                                                               const StartPoses& start);
  [[nodiscard]] bool fits_by_odometry(const Match& match, const StartPoses& start) const;
  [[nodiscard]] std::optional<FoundPose> wait_for_people(const LevelScan& scan);

  PlaceSearch& place_search_;
  const BackEnd& back_end_;
  MovingPointFilter& moving_points_;
  const PoseGuesses& pose_guesses_;
  const Doubt& doubt_;
  PeopleParams people_params_;
  LostParams lost_params_;
  DoubtParams doubt_params_;
  std::optional<time::Timestamp> hidden_since_;  // the first scan of which people hide too much
};

}  // namespace nodmap::slam2d
