// SPDX-License-Identifier: BSD-3-Clause
#include "common/geometry/pose_history.hpp"

#include <algorithm>
#include <chrono>

#include "common/geometry/pose_tolerance.hpp"

namespace nodmap::geometry {
namespace {

constexpr time::Duration kLongestWait = 500ms;
// A robot that has moved by no more was stationary: what scans see moves by a fraction of their
// noise.
constexpr PoseTolerance kStationary{.distance_m = 0.01, .rotation_rad = 0.002};

}  // namespace

bool PoseHistory::add(time::Timestamp stamp, const SE3& T_odom_base) {
  if (!T_odom_base.matrix().allFinite()) {
    return false;
  }
  while (!samples_.empty() && samples_.back().stamp >= stamp) {
    samples_.pop_back();
  }
  samples_.push_back({stamp, T_odom_base});
  while (samples_.size() > 2 && samples_[1].stamp < stamp - span_) {
    samples_.pop_front();
  }
  return true;
}

std::optional<SE3> PoseHistory::at(time::Timestamp stamp) const {
  if (samples_.empty() || stamp > samples_.back().stamp + max_extrapolation_ ||
      stamp < samples_.front().stamp - max_extrapolation_) {
    return std::nullopt;
  }
  if (stamp <= samples_.front().stamp) {
    return samples_.front().T_odom_base;
  }
  if (stamp > samples_.back().stamp) {
    return extrapolate_beyond_newest(stamp);
  }
  return interpolate_at(stamp);
}

std::optional<SE3> PoseHistory::interpolate_at(time::Timestamp stamp) const {
  const auto after =
      std::lower_bound(samples_.begin(), samples_.end(), stamp,
                       [](const Sample& s, time::Timestamp t) { return s.stamp < t; });
  if (after->stamp == stamp) {
    return after->T_odom_base;  // exact, without the rounding of an interpolation
  }
  const auto before = std::prev(after);
  if (after->stamp - before->stamp > max_interpolation_ &&
      !is_within(before->T_odom_base, after->T_odom_base, kStationary)) {
    return std::nullopt;
  }
  const double fraction = time::ratio(stamp - before->stamp, after->stamp - before->stamp);
  return interpolate(before->T_odom_base, after->T_odom_base, fraction);
}

bool PoseHistory::is_awaited(time::Timestamp stamp, time::Timestamp now) const {
  return !samples_.empty() && stamp > samples_.back().stamp + max_extrapolation_ && now >= stamp &&
         now - stamp <= kLongestWait;
}

std::optional<SE3> PoseHistory::newest() const {
  return samples_.empty() ? std::nullopt : std::optional(samples_.back().T_odom_base);
}

SE3 PoseHistory::extrapolate_beyond_newest(time::Timestamp stamp) const {
  const Sample& newest = samples_.back();
  if (samples_.size() < 2) {
    return newest.T_odom_base;
  }
  const Sample& before = samples_[samples_.size() - 2];
  const time::Duration spacing = newest.stamp - before.stamp;
  // Hold the pose if the velocity is unknown: two samples with nearly the same stamp give none, two
  // far apart not the present one.
  if (spacing < 1ms || spacing > 1s) {
    return newest.T_odom_base;
  }
  const double fraction = time::ratio(stamp - before.stamp, spacing);
  return interpolate(before.T_odom_base, newest.T_odom_base, fraction);
}

}  // namespace nodmap::geometry
