// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "common/geometry/se3.hpp"

namespace nodmap::geometry {

/// The odometry of the last seconds, to be asked for the pose at the time of a measurement.
///
/// Samples are kept in the order they arrive. A sample whose stamp steps back (a clock was set, or
/// two hosts stamped one log) takes the place of everything it contradicts: the newest word wins.
class PoseHistory {
 public:
  /// `span_us`: how far back poses are kept. `max_extrapolation_us`: how far beyond the newest (or
  /// before the oldest) sample a pose is still answered.
  explicit PoseHistory(std::int64_t span_us = 60'000'000,
                       std::int64_t max_extrapolation_us = 50'000)
      : span_us_(span_us), max_extrapolation_us_(max_extrapolation_us) {}

  /// Non-finite poses are refused; returns whether the sample was taken.
  bool add(std::int64_t utime_us, const SE3& T_odom_base);

  /// The pose at a time: interpolated between samples, extrapolated at the velocity of the last two
  /// for at most `max_extrapolation_us`, otherwise empty.
  [[nodiscard]] std::optional<SE3> at(std::int64_t utime_us) const;

  /// The sample with the latest stamp.
  [[nodiscard]] std::optional<SE3> newest() const;

  /// Forgets all: what comes is in another frame, and nothing is interpolated between the two.
  void clear() { samples_.clear(); }

  [[nodiscard]] bool empty() const { return samples_.empty(); }

 private:
  struct Sample {
    std::int64_t utime_us = 0;
    SE3 T_odom_base = SE3::Identity();
  };

  [[nodiscard]] SE3 extrapolate_beyond_newest(std::int64_t utime_us) const;

  std::int64_t span_us_;
  std::int64_t max_extrapolation_us_;
  std::deque<Sample> samples_;  // strictly increasing stamps
};

}  // namespace nodmap::geometry
