// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/scan_joiner.hpp"

#include <algorithm>
#include <utility>

namespace nodmap::laser3d {
namespace {

constexpr std::int64_t kHistoryUs = 1'000'000;
// Between samples farther apart than this nobody knows what the head did.
constexpr std::int64_t kMaxGapUs = 60'000;
// How long a revolution waits for a sample after its last beam.
constexpr std::int64_t kPatienceUs = 30'000;
// More revolutions than can wait for so long at 75 Hz, with room for bursts.
constexpr std::size_t kMostWaiting = 16;

double seconds(std::int64_t duration_us) {
  return 1e-6 * static_cast<double>(duration_us);
}

}  // namespace

void ScanJoiner::add(const PitchSample& sample) {
  if (!samples_.empty() && sample.time_us <= samples_.back().time_us) {
    return;
  }
  samples_.push_back(sample);
  while (samples_.front().time_us < sample.time_us - kHistoryUs) {
    samples_.pop_front();
  }
}

void ScanJoiner::add(MirrorRevolution revolution) {
  if (waiting_.size() == kMostWaiting) {
    waiting_.pop_front();
    ++dropped_;
  }
  waiting_.push_back(std::move(revolution));
}

std::optional<PitchedRevolution> ScanJoiner::next(std::int64_t now_us) {
  while (!waiting_.empty()) {
    const std::int64_t first_us = waiting_.front().first_beam_us;
    const std::int64_t last_us = waiting_.front().last_beam_us;
    const bool covered = !samples_.empty() && samples_.back().time_us >= last_us;
    if (!covered && now_us < last_us + kPatienceUs) {
      return std::nullopt;
    }
    MirrorRevolution revolution = std::move(waiting_.front());
    waiting_.pop_front();
    const std::optional<double> pitch_first_rad = pitch_at(first_us);
    const std::optional<double> pitch_last_rad = pitch_at(last_us);
    if (pitch_first_rad && pitch_last_rad) {
      return PitchedRevolution{std::move(revolution), *pitch_first_rad, *pitch_last_rad};
    }
    ++dropped_;
  }
  return std::nullopt;
}

std::optional<double> ScanJoiner::pitch_at(std::int64_t time_us) const {
  const auto after = std::lower_bound(
      samples_.begin(), samples_.end(), time_us,
      [](const PitchSample& sample, std::int64_t t_us) { return sample.time_us < t_us; });
  if (after == samples_.end()) {
    if (samples_.empty() || static_cast<double>(time_us - samples_.back().time_us) >
                                1e6 * params_.max_extrapolation_s) {
      return std::nullopt;
    }
    const PitchSample& newest = samples_.back();
    return newest.pitch_rad + newest.rate_rad_s * seconds(time_us - newest.time_us);
  }
  if (after->time_us == time_us) {
    return after->pitch_rad;
  }
  if (after == samples_.begin()) {
    return std::nullopt;
  }
  const PitchSample& before = *(after - 1);
  const std::int64_t gap_us = after->time_us - before.time_us;
  if (gap_us > kMaxGapUs) {
    return std::nullopt;
  }
  const double ratio = static_cast<double>(time_us - before.time_us) / static_cast<double>(gap_us);
  return before.pitch_rad + ratio * (after->pitch_rad - before.pitch_rad);
}

}  // namespace nodmap::laser3d
