// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "common/geometry/se3.hpp"

namespace nodmap::geometry {

/// Stores the odometry of the last seconds and interpolates the pose at the time of a measurement.
///
/// If the stamp of a new sample steps back (a clock was set, or two hosts stamped one log), the
/// sample replaces all stored samples with later stamps: the newest information wins.
class PoseHistory {
 public:
  /// `span_us`: how long poses are kept. `max_extrapolation_us`: how far beyond the newest (or
  /// before the oldest) sample at() still returns a pose.
  explicit PoseHistory(std::int64_t span_us = 60'000'000,
                       std::int64_t max_extrapolation_us = 50'000)
      : span_us_(span_us), max_extrapolation_us_(max_extrapolation_us) {}

  /// Adds a sample; returns false if the pose is not finite.
  bool add(std::int64_t utime_us, const SE3& T_odom_base);

  /// The pose at a time: interpolated between samples; after the newest sample extrapolated at the
  /// velocity of the last two; before the oldest sample the oldest pose. Empty if the time is more
  /// than `max_extrapolation_us` outside the samples.
  [[nodiscard]] std::optional<SE3> at(std::int64_t utime_us) const;

  /// The sample with the latest stamp.
  [[nodiscard]] std::optional<SE3> newest() const;

  /// Removes all samples: to be called when following samples are in another frame.
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
