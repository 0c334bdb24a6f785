// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "modules/slam2d/back_end/back_end.hpp"
#include "modules/slam2d/front_end/doubt.hpp"
#include "modules/slam2d/front_end/hidden_view.hpp"
#include "modules/slam2d/front_end/moving_points.hpp"
#include "modules/slam2d/front_end/place_search.hpp"
#include "modules/slam2d/front_end/pose_guesses.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/scan/level_scan.hpp"

namespace nodmap::slam2d {

/// The place of a scan, and how it was found.
struct FoundPose {
  MatchedPose pose;
  LevelScan scan;                   ///< without the points that have moved
  bool odometry_was_wrong = false;  ///< the view seemed hidden, but not by people who pass
  bool is_hidden = false;           ///< people surround the robot: its pose is by odometry alone
};

/// Finds the pose of each scan: by a match or a search of the points that people leave of it. Where
/// these do not tell the place, and the robot cannot be elsewhere, the pose is by odometry until
/// people have had time to pass.
class PoseFinder {
 public:
  /// The parts that it uses must outlive it.
  PoseFinder(const Slam2dParams& params, PlaceSearch& place_search, const BackEnd& back_end,
             MovingPointFilter& moving_points, const PoseGuesses& pose_guesses, const Doubt& doubt)
      : place_search_(place_search),
        back_end_(back_end),
        moving_points_(moving_points),
        pose_guesses_(pose_guesses),
        doubt_(doubt),
        lost_params_(params.lost),
        doubt_params_(params.doubt),
        hidden_view_(params.people) {}

  /// Matches a scan or, if that does not fit, searches its place.
  [[nodiscard]] FoundPose match_or_search(const LevelScan& all_points, const StartPoses& start);

 private:
  [[nodiscard]] LevelScan without_moving_points(const LevelScan& all_points,
                                                const StartPoses& start);
  [[nodiscard]] bool is_smooth(const LevelScan& scan, const StartPoses& start) const;
  [[nodiscard]] std::optional<MatchedPose> find_between_people(const LevelScan& scan,
                                                               const LevelScan& all_points,
                                                               const StartPoses& start);
  [[nodiscard]] bool fits_by_odometry(const Match& match, const StartPoses& start) const;

  PlaceSearch& place_search_;
  const BackEnd& back_end_;
  MovingPointFilter& moving_points_;
  const PoseGuesses& pose_guesses_;
  const Doubt& doubt_;
  LostParams lost_params_;
  DoubtParams doubt_params_;
  HiddenView hidden_view_;
};

}  // namespace nodmap::slam2d
