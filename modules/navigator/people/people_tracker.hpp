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

namespace nodmap::navigator {

/// Estimates position and velocity of one person with a Kalman filter: constant velocity, driven by
/// white acceleration. The nodding laser sees a person for a few scans of each sweep; in between
/// the covariance grows.
class Track {
 public:
  /// Spectral density of the acceleration: in a second the velocity changes by about 0.5 m/s.
  static constexpr double kAccelerationDensity = 0.3;  // m^2/s^3
  /// Error of a detection's centre: noise, and the unknown middle of the body. It is larger than a
  /// single scan would need, because the scans of a sweep share the second part.
  static constexpr double kPositionSigmaM = 0.08;
  /// Error of the velocity before it is known: people walk at up to 1.4 m/s in any direction.
  static constexpr double kVelocitySigmaMps = 1.0;

  /// `laser_is_held`: the laser does not nod and measures at one height only.
  Track(time::Timestamp stamp, const Detection& detection, std::int64_t id = 0,
        bool laser_is_held = false);

  void predict(time::Timestamp stamp);
  /// Call predict() to the time of the detection first.
  void update(const Detection& detection);

  /// How many standard deviations a detection lies from the prediction, squared.
  [[nodiscard]] double distance_squared(const Detection& detection) const;

  /// The person at the time of the last prediction, in odom.
  [[nodiscard]] Person person() const;

  /// Reverses the velocity.
  void turn_round();

  [[nodiscard]] time::Timestamp seen_at() const { return seen_at_; }
  /// Number of scans since seen_at() with beams that have passed through its middle.
  [[nodiscard]] int num_contradictions() const { return num_contradictions_; }
  void contradict() { ++num_contradictions_; }
  /// The last time at which it was seen or was out of view, beside or behind the robot.
  [[nodiscard]] time::Timestamp missed_since() const { return std::max(seen_at_, hidden_at_); }
  void hide(time::Timestamp stamp) { hidden_at_ = stamp; }
  /// Seen in at least two sweeps, at the heights of a leg, and faster than its velocity error.
  [[nodiscard]] bool moves() const { return moves_; }
  /// Seen in some scans of the last two sweeps, but too few to say that it moves.
  [[nodiscard]] bool is_new() const;

 private:
  [[nodiscard]] bool has_legs() const;

  std::int64_t id_;
  Eigen::Vector4d state_;  // position, velocity; odom
  Eigen::Matrix4d covariance_;
  double radius_m_;
  time::Timestamp stamp_;
  time::Timestamp first_seen_;
  time::Timestamp seen_at_;
  time::Timestamp hidden_at_{};
  int num_sightings_ = 1;
  int num_contradictions_ = 0;
  bool laser_is_held_;
  double lowest_m_;  // lowest and highest hit above the floor
  double highest_m_;
  bool has_come_;  // it was measured where space was free before
  bool moves_ = false;
};

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
