// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/sweep/sweep_segmenter.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace nodmap::slam6d {
namespace {

// Within this fraction of the hysteresis from the extreme, the servo counts as at its reversal.
constexpr double kReversalFraction = 0.1;

}  // namespace

std::optional<Sweep> SweepSegmenter::add(scan::Scan scan) {
  std::optional<Sweep> complete;
  if (const auto end = end_before(scan)) {
    complete = cut(running_.scans.size(), *end);
    if (*end != Sweep::End::kFull) {
      direction_ = 0;
    }
  }
  running_.scans.push_back(std::move(scan));
  const double pitch_rad = running_.scans.back().pitch_mid_rad();
  track(pitch_rad, running_.scans.size());
  const bool is_up = pitch_rad > lowest_.pitch_rad + params_.reversal_hysteresis_rad;
  const bool is_down = pitch_rad < highest_.pitch_rad - params_.reversal_hysteresis_rad;
  if (direction_ == 0) {
    direction_ = static_cast<int>(is_up) - static_cast<int>(is_down);
  } else if (direction_ > 0 ? is_down : is_up) {
    complete = cut((direction_ > 0 ? highest_ : lowest_).num_scans, Sweep::End::kReversal);
    direction_ = -direction_;
  }
  return complete;
}

std::optional<Sweep> SweepSegmenter::flush() {
  direction_ = 0;
  if (running_.scans.empty()) {
    return std::nullopt;
  }
  return cut(running_.scans.size(), Sweep::End::kFlushed);
}

std::optional<Sweep::End> SweepSegmenter::end_before(const scan::Scan& next) const {
  if (running_.scans.empty()) {
    return std::nullopt;
  }
  const scan::Scan& last = running_.scans.back();
  if (next.stamp < last.stamp || time::seconds(next.stamp - last.last_stamp()) > params_.gap_s) {
    return Sweep::End::kInterrupted;
  }
  const double step_rad = next.pitch_mid_rad() - last.pitch_mid_rad();
  if (direction_ * step_rad < -params_.jump_back_rad) {
    return Sweep::End::kJumpBack;
  }
  if (running_.scans.size() >= static_cast<std::size_t>(params_.max_scans)) {
    return Sweep::End::kFull;
  }
  return std::nullopt;
}

// The first `num_scans` of the running sweep are complete, the others begin the next one.
Sweep SweepSegmenter::cut(std::size_t num_scans, Sweep::End end) {
  const auto first_of_next = running_.scans.begin() + static_cast<std::ptrdiff_t>(num_scans);
  Sweep next;
  next.follows_interruption = end == Sweep::End::kInterrupted;
  next.scans.assign(std::make_move_iterator(first_of_next),
                    std::make_move_iterator(running_.scans.end()));
  running_.scans.erase(first_of_next, running_.scans.end());
  running_.end = end;
  Sweep complete = std::exchange(running_, std::move(next));
  highest_ = lowest_ = {};
  for (std::size_t i = 0; i < running_.scans.size(); ++i) {
    track(running_.scans[i].pitch_mid_rad(), i + 1);
  }
  return complete;
}

void SweepSegmenter::track(double pitch_rad, std::size_t num_scans) {
  if (num_scans == 1) {
    highest_ = lowest_ = {pitch_rad, 1};
    return;
  }
  const double reversal_rad = kReversalFraction * params_.reversal_hysteresis_rad;
  if (pitch_rad >= highest_.pitch_rad - reversal_rad) {
    highest_ = {std::max(pitch_rad, highest_.pitch_rad), num_scans};
  }
  if (pitch_rad <= lowest_.pitch_rad + reversal_rad) {
    lowest_ = {std::min(pitch_rad, lowest_.pitch_rad), num_scans};
  }
}

}  // namespace nodmap::slam6d
