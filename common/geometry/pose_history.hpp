// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>

#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::geometry {

/// Stores the odometry of the last seconds and interpolates the pose at the time of a measurement.
///
/// If the stamp of a new sample steps back (a clock was set, or two hosts stamped one log), the
/// sample replaces all stored samples with later stamps: the newest information wins.
///
/// Between two samples far apart a robot that has moved can have taken any path: there is no pose.
class PoseHistory {
 public:
  /// `span`: how long poses are kept. `max_extrapolation`: how far beyond the newest (or
  /// before the oldest) sample at() still returns a pose. `max_interpolation`: how far apart two
  /// samples may be of which at() interpolates the motion. A second is long for odometry, which
  /// comes 5 times a second or more.
  explicit PoseHistory(time::Duration span = 60s, time::Duration max_extrapolation = 50ms,
                       time::Duration max_interpolation = 1s)
      : span_(span), max_extrapolation_(max_extrapolation), max_interpolation_(max_interpolation) {}

  /// Adds a sample; returns false if the pose is not finite.
  bool add(time::Timestamp stamp, const SE3& T_odom_base);

  /// The pose at a time: interpolated between samples; after the newest sample extrapolated at the
  /// velocity of the last two; before the oldest sample the oldest pose. Empty if the time is more
  /// than `max_extrapolation` outside the samples, or between two that are more than
  /// `max_interpolation` apart while the robot has moved.
  [[nodiscard]] std::optional<SE3> at(time::Timestamp stamp) const;

  /// Whether a measurement at a time should wait for its pose: it is too far beyond the newest
  /// sample, and newer ones may still come. They do within half a second (`now` is the time of the
  /// newest measurement) at 5 samples a second, even if one is lost. Not without any sample, nor
  /// if `now` is before the measurement: the clock was set back, and samples of the new time do not
  /// tell it.
  [[nodiscard]] bool is_awaited(time::Timestamp stamp, time::Timestamp now) const;

  /// The sample with the latest stamp.
  [[nodiscard]] std::optional<SE3> newest() const;

  /// Removes all samples: to be called when following samples are in another frame.
  void clear() { samples_.clear(); }

  [[nodiscard]] bool empty() const { return samples_.empty(); }

 private:
  struct Sample {
    time::Timestamp stamp{};
    SE3 T_odom_base = SE3::Identity();
  };

  [[nodiscard]] std::optional<SE3> interpolate_at(time::Timestamp stamp) const;
  [[nodiscard]] SE3 extrapolate_beyond_newest(time::Timestamp stamp) const;

  time::Duration span_;
  time::Duration max_extrapolation_;
  time::Duration max_interpolation_;
  std::deque<Sample> samples_;  // strictly increasing stamps
};

}  // namespace nodmap::geometry
