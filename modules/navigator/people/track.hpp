// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

#include "common/geometry/time.hpp"
#include "modules/navigator/people/detection.hpp"
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
  /// Error of a person whose other leg is hidden: the one in view is up to 0.2 m from their middle,
  /// and for all of a sweep on the same side.
  static constexpr double kLegSigmaM = 0.25;
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
  /// Since when it has been in view without being detected.
  [[nodiscard]] time::Timestamp missed_since() const { return std::max(seen_at_, hidden_at_); }
  void hide(time::Timestamp stamp) { hidden_at_ = stamp; }
  /// Seen in at least two sweeps, at the heights of a leg, and faster than its velocity error.
  [[nodiscard]] bool moves() const { return moves_; }
  /// Seen in some scans of the last two sweeps, but too few to say that it moves, and for less than
  /// two seconds; or it has stopped less than two seconds ago.
  [[nodiscard]] bool is_new() const;

 private:
  [[nodiscard]] bool has_legs() const;
  /// Standard deviation of a detection's centre as the person's, in each direction.
  [[nodiscard]] double sigma_m(const Detection& detection) const {
    return is_one_of_two_legs(detection) ? kLegSigmaM : kPositionSigmaM;
  }
  [[nodiscard]] bool is_one_of_two_legs(const Detection& detection) const {
    return has_two_legs_ && detection.num_legs == 1;
  }

  std::int64_t id_;
  Eigen::Vector4d state_;  // position, velocity; odom
  Eigen::Matrix4d covariance_;
  double radius_m_;
  time::Timestamp stamp_;
  time::Timestamp first_seen_;
  time::Timestamp seen_at_;
  time::Timestamp stationary_since_;  // first_seen_, until it has moved
  time::Timestamp hidden_at_{};
  int num_sightings_ = 1;
  int num_contradictions_ = 0;
  bool laser_is_held_;
  double lowest_m_;  // lowest and highest hit above the floor
  double highest_m_;
  bool has_come_;      // it was measured where space was free before
  bool has_two_legs_;  // both were measured at once
  bool moves_ = false;
};

}  // namespace nodmap::navigator
