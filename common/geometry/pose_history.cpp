// SPDX-License-Identifier: BSD-3-Clause
#include "common/geometry/pose_history.hpp"

#include <algorithm>

namespace nodmap::geometry {

bool PoseHistory::add(std::int64_t utime_us, const SE3& T_odom_base) {
  if (!T_odom_base.matrix().allFinite()) {
    return false;
  }
  while (!samples_.empty() && samples_.back().utime_us >= utime_us) {
    samples_.pop_back();
  }
  samples_.push_back({utime_us, T_odom_base});
  while (samples_.size() > 2 && samples_[1].utime_us < utime_us - span_us_) {
    samples_.pop_front();
  }
  return true;
}

std::optional<SE3> PoseHistory::at(std::int64_t utime_us) const {
  if (samples_.empty() || utime_us > samples_.back().utime_us + max_extrapolation_us_ ||
      utime_us < samples_.front().utime_us - max_extrapolation_us_) {
    return std::nullopt;
  }
  if (utime_us <= samples_.front().utime_us) {
    return samples_.front().T_odom_base;
  }
  if (utime_us > samples_.back().utime_us) {
    return extrapolate_beyond_newest(utime_us);
  }
  const auto after =
      std::lower_bound(samples_.begin(), samples_.end(), utime_us,
                       [](const Sample& s, std::int64_t t) { return s.utime_us < t; });
  if (after->utime_us == utime_us) {
    return after->T_odom_base;  // exact, without the rounding of an interpolation
  }
  const auto before = std::prev(after);
  const double fraction = static_cast<double>(utime_us - before->utime_us) /
                          static_cast<double>(after->utime_us - before->utime_us);
  return interpolate(before->T_odom_base, after->T_odom_base, fraction);
}

std::optional<SE3> PoseHistory::newest() const {
  return samples_.empty() ? std::nullopt : std::optional(samples_.back().T_odom_base);
}

SE3 PoseHistory::extrapolate_beyond_newest(std::int64_t utime_us) const {
  const Sample& newest = samples_.back();
  if (samples_.size() < 2) {
    return newest.T_odom_base;
  }
  const Sample& before = samples_[samples_.size() - 2];
  const std::int64_t spacing_us = newest.utime_us - before.utime_us;
  // Two samples with nearly one stamp say nothing of the velocity, two far apart nothing of the
  // present one: hold the pose.
  if (spacing_us < 1'000 || spacing_us > 1'000'000) {
    return newest.T_odom_base;
  }
  const double fraction =
      static_cast<double>(utime_us - before.utime_us) / static_cast<double>(spacing_us);
  return interpolate(before.T_odom_base, newest.T_odom_base, fraction);
}

}  // namespace nodmap::geometry
