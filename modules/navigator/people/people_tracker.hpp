// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "common/scan/scan.hpp"
#include "modules/navigator/people/motion_detector.hpp"
#include "modules/navigator/people/person.hpp"
#include "modules/navigator/people/track.hpp"

namespace nodmap::navigator {

/// People in odom, in the axes of base now.
[[nodiscard]] People in_base(People people_odom, const geometry::SE2& T_odom_base);

/// Tracks everything that moves in view of the laser. Somebody who stands still is no longer a
/// track after a while, but an obstacle like any other. A person who has left the view, beside or
/// behind the robot, is predicted to walk on, and to turn round before obstacles.
class PeopleTracker {
 public:
  /// Whether there is an obstacle at a place in odom.
  using IsBlocked = std::function<bool(const Eigen::Vector2d& p_odom)>;

  /// Adds a scan. `T_odom_base`: at its middle. `laser_is_held`: the laser does not nod. Without
  /// `is_blocked` nobody is predicted to turn round.
  void add_scan(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                const IsBlocked& is_blocked = {}, bool laser_is_held = false);

  /// A scan was taken in which nobody can be detected: tracks are predicted, and end when they are
  /// lost.
  void add_blind_scan(time::Timestamp stamp);

  /// For each beam of the last scan, whether it has hit a moving track, at any height.
  [[nodiscard]] const std::vector<bool>& is_walker() const { return is_walker_; }

  /// The moving tracks, predicted to this time, in odom.
  [[nodiscard]] People people_odom(time::Timestamp stamp) const;

  /// Tracks that are too new to have a velocity, in places that were free before. In odom.
  [[nodiscard]] People newcomers_odom(time::Timestamp stamp) const;

  /// Whether somebody of people_odom() is nearer than this to a place in odom.
  [[nodiscard]] bool is_anybody_near(const Eigen::Vector2d& p_odom, double distance_m,
                                     time::Timestamp stamp) const;

 private:
  template <class Select>
  [[nodiscard]] People select(time::Timestamp stamp, const Select& is_wanted) const;
  void associate(const std::vector<Detection>& detections, time::Timestamp stamp,
                 bool laser_is_held);
  void mark_walkers(const scan::Scan& scan, const geometry::SE2& T_odom_base);
  void follow_unseen(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                     const IsBlocked& is_blocked);
  void contradict_passed();
  void drop_lost(time::Timestamp stamp);
  void drop_doubles(time::Timestamp stamp);

  MotionDetector detector_;
  std::vector<Track> tracks_;
  std::int64_t next_id_ = 0;
  std::vector<bool> is_walker_;
};

}  // namespace nodmap::navigator
