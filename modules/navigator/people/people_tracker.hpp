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

/// Position and velocity of a walker by a Kalman filter: constant velocity, driven by white
/// acceleration. The nodding laser sees a person for a few scans of each sweep; in between the
/// covariance grows.
class Track {
 public:
  /// Spectral density of the acceleration: in a second the velocity changes by about 0.5 m/s.
  static constexpr double kAccelerationDensity = 0.3;  // m^2/s^3
  /// Error of a detection's centre: noise, and the unknown middle of the body. The scans of a sweep
  /// share the latter, so it is larger than that of a single scan.
  static constexpr double kPositionSigmaM = 0.08;
  /// Error of the velocity before it is known: people walk at up to 1.4 m/s in any direction.
  static constexpr double kVelocitySigmaMps = 1.0;

  /// `laser_is_held`: the laser does not nod, so everything is measured at one height only.
  Track(time::Timestamp stamp, const Detection& detection, std::int64_t id = 0,
        bool laser_is_held = false);

  void predict(time::Timestamp stamp);
  /// After predict() to the time of the detection.
  void update(const Detection& detection);

  /// How many standard deviations a detection lies from the prediction, squared.
  [[nodiscard]] double distance_squared(const Detection& detection) const;

  /// At the time of the last prediction, in odom.
  [[nodiscard]] Person person() const;

  /// Reverses the velocity.
  void turn_round();

  [[nodiscard]] time::Timestamp seen_at() const { return seen_at_; }
  /// Number of scans since then with beams that have passed through its middle.
  [[nodiscard]] int num_contradictions() const { return num_contradictions_; }
  void contradict() { ++num_contradictions_; }
  /// The last time it was seen, or could not be: beside or behind the robot.
  [[nodiscard]] time::Timestamp missed_since() const { return std::max(seen_at_, hidden_at_); }
  void hide(time::Timestamp stamp) { hidden_at_ = stamp; }
  /// Seen in at least two sweeps, at the heights of a leg, and faster than its velocity error.
  [[nodiscard]] bool moves() const { return moves_; }
  /// Seen in a few scans of the last two sweeps, too few to say that it moves.
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
  double lowest_m_;  // lowest and highest hit
  double highest_m_;
  bool has_come_;  // it was measured where space was free before
  bool moves_ = false;
};

/// Tracks everything that moves in view of the laser. Somebody who stands still stops being a track
/// after a while, and is an obstacle like any other.
///
/// A person who has left the view, beside or behind the robot, is predicted to walk on and to turn
/// round before obstacles.
class PeopleTracker {
 public:
  /// Whether something stands at a place in odom.
  using IsBlocked = std::function<bool(const Eigen::Vector2d& p_odom)>;

  /// `T_odom_base`: at the middle of the scan. Without `is_blocked` nobody turns round.
  /// `laser_is_held`: the laser does not nod.
  void add_scan(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                const IsBlocked& is_blocked = {}, bool laser_is_held = false);

  /// For each beam of the last scan, whether it has hit a moving track, at any height.
  [[nodiscard]] const std::vector<bool>& is_walker() const { return is_walker_; }

  /// The moving tracks, predicted to this time, in odom.
  [[nodiscard]] People people_odom(time::Timestamp stamp) const;

  /// The same in the axes of base now.
  [[nodiscard]] People people_base(time::Timestamp stamp, const geometry::SE2& T_odom_base) const;

  /// Tracks too new to tell a velocity, in places where space was free. In odom.
  [[nodiscard]] People newcomers_odom(time::Timestamp stamp) const;

  /// The same in the axes of base now.
  [[nodiscard]] People newcomers_base(time::Timestamp stamp,
                                      const geometry::SE2& T_odom_base) const;

 private:
  template <class Select>
  [[nodiscard]] People select(time::Timestamp stamp, const Select& is_wanted) const;
  void associate(const std::vector<Detection>& detections, time::Timestamp stamp,
                 bool laser_is_held);
  void mark_walkers(const scan::Scan& scan, const geometry::SE2& T_odom_base);
  void follow_unseen(const scan::Scan& scan, const geometry::SE2& T_odom_base,
                     const IsBlocked& is_blocked);
  void drop_lost(time::Timestamp stamp);
  void drop_doubles(time::Timestamp stamp);

  MotionDetector detector_;
  std::vector<Track> tracks_;
  std::int64_t next_id_ = 0;
  std::vector<bool> is_walker_;
};

}  // namespace nodmap::navigator
