// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/scan_joiner.hpp"

#include <algorithm>
#include <utility>

namespace nodmap::laser3d {
namespace {

constexpr time::Duration kHistory = 1s;
// Between samples farther apart than this the pitch is unknown.
constexpr time::Duration kMaxGap = 60ms;
// How long a revolution waits for a pitch sample later than its last beam.
constexpr time::Duration kPitchPatience = 30ms;
// More than the revolutions that wait for this long at 75 Hz, with room for bursts.
constexpr std::size_t kMaxWaiting = 16;

}  // namespace

void ScanJoiner::add(const PitchSample& sample) {
  if (!samples_.empty() && sample.stamp <= samples_.back().stamp) {
    return;
  }
  samples_.push_back(sample);
  while (samples_.front().stamp < sample.stamp - kHistory) {
    samples_.pop_front();
  }
}

void ScanJoiner::add(MirrorRevolution revolution) {
  if (waiting_.size() == kMaxWaiting) {
    waiting_.pop_front();
    ++dropped_;
  }
  waiting_.push_back(std::move(revolution));
}

std::optional<PitchedRevolution> ScanJoiner::next(time::SteadyTime now) {
  while (!waiting_.empty()) {
    const time::SteadyTime first = waiting_.front().first_beam;
    const time::SteadyTime last = waiting_.front().last_beam;
    const bool covered = !samples_.empty() && samples_.back().stamp >= last;
    if (!covered && now < last + kPitchPatience) {
      return std::nullopt;
    }
    MirrorRevolution revolution = std::move(waiting_.front());
    waiting_.pop_front();
    const std::optional<double> pitch_first_rad = pitch_at(first);
    const std::optional<double> pitch_last_rad = pitch_at(last);
    if (pitch_first_rad && pitch_last_rad) {
      return PitchedRevolution{std::move(revolution), *pitch_first_rad, *pitch_last_rad};
    }
    ++dropped_;
  }
  return std::nullopt;
}

std::optional<double> ScanJoiner::pitch_at(time::SteadyTime stamp) const {
  const auto after = std::ranges::lower_bound(samples_, stamp, {}, &PitchSample::stamp);
  if (after == samples_.end()) {
    if (samples_.empty() ||
        time::seconds(stamp - samples_.back().stamp) > params_.max_extrapolation_s) {
      return std::nullopt;
    }
    const PitchSample& newest = samples_.back();
    return newest.pitch_rad + newest.rate_rad_s * time::seconds(stamp - newest.stamp);
  }
  if (after->stamp == stamp) {
    return after->pitch_rad;
  }
  if (after == samples_.begin()) {
    return std::nullopt;
  }
  const PitchSample& before = *(after - 1);
  const time::Duration gap = after->stamp - before.stamp;
  if (gap > kMaxGap) {
    return std::nullopt;
  }
  const double ratio = time::FineDuration(stamp - before.stamp) / gap;
  return before.pitch_rad + ratio * (after->pitch_rad - before.pitch_rad);
}

}  // namespace nodmap::laser3d
