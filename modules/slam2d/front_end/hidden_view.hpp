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
struct FoundPlace {
  Place place;
  LevelScan scan;            ///< without the points that have moved
  bool has_slipped = false;  ///< odometry, not people, has been wrong for a second
  bool is_hidden = false;    ///< people surround the robot: its pose is by odometry alone
};

/// The view that people hide. Finds the place of a scan from what they leave of it. Where that does
/// not tell the place, and the robot cannot be elsewhere, its pose is by odometry until people have
/// had time to pass.
class HiddenView {
 public:
  /// The state at the time of a scan.
  struct Known {
    PlaceSearch& place_search;
    BackEnd& back_end;
    MovingPointFilter& moving_points;
    const PoseGuesses& pose_guesses;
    const Doubt& doubt;
  };

  explicit HiddenView(const Slam2dParams& params)
      : people_params_(params.people), lost_params_(params.lost), doubt_params_(params.doubt) {}

  /// Finds the place of a scan; valid until the next call.
  [[nodiscard]] FoundPlace find_place(const Known& known, const LevelScan& all_points,
                                      const Start& start);

 private:
  [[nodiscard]] std::optional<Place> find_between_people(const Known& known, const LevelScan& scan,
                                                         const LevelScan& all_points,
                                                         const Start& start) const;
  [[nodiscard]] bool fits_by_odometry(const Match& match, const Start& start) const;
  [[nodiscard]] std::optional<FoundPlace> wait_for_people(const LevelScan& scan);

  PeopleParams people_params_;
  LostParams lost_params_;
  DoubtParams doubt_params_;
  std::optional<time::Timestamp> hidden_since_;  // the first scan of which people hide too much
};

}  // namespace nodmap::slam2d
