// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/scan/scan.hpp"

namespace nodmap::slam6d {

/// The scans of one complete pitch movement (IV B), in the order in which they came.
struct Sweep {
  enum class End {
    kTurningPoint,
    kJumpBack,     ///< the pitch went back in one step: a scanner that sweeps one way only
    kInterrupted,  ///< a pause, or stamps that step back
    kFull,         ///< as many scans as a sweep may have
    kFlushed       ///< the end of the recording
  };

  std::vector<scan::Scan> scans;
  End end = End::kFlushed;
  /// Whether the stream was interrupted before the first scan: nobody knows what happened
  /// meanwhile.
  bool follows_interruption = false;
};

/// Cuts the continuous stream of scans at the turning points of the pitch. Every scan given in
/// comes out once (R40); scans between which the pitch stands still belong to the running sweep.
class SweepSegmenter {
 public:
  struct Options {
    /// A turning point is one when the pitch has come back from it by this much: more than the
    /// servo's noise.
    double reversal_hysteresis_rad = geometry::deg_to_rad(1.0);
    /// A single step against the movement beyond this is a new start, not a turn.
    double jump_back_rad = geometry::deg_to_rad(10.0);
    std::int64_t gap_us = 1'000'000;
    std::size_t max_scans = 1000;
  };

  explicit SweepSegmenter(const Options& options) : options_(options) {}

  /// Takes the next scan; returns the sweep that is known to be complete by it.
  [[nodiscard]] std::optional<Sweep> add(scan::Scan scan);

  /// What is left at the end of the stream.
  [[nodiscard]] std::optional<Sweep> flush();

 private:
  [[nodiscard]] std::optional<Sweep::End> end_before(const scan::Scan& next) const;
  [[nodiscard]] Sweep cut(std::size_t num_scans, Sweep::End end);
  void track(double pitch_rad, std::size_t num_scans);

  // The pitch farthest along one way, and how many scans of the sweep led there.
  struct Extreme {
    double pitch_rad = 0.0;
    std::size_t num_scans = 0;
  };

  Options options_;
  Sweep running_;
  int direction_ = 0;  // of the pitch: +1 up, -1 down, 0 not known yet
  Extreme highest_;
  Extreme lowest_;
};

}  // namespace nodmap::slam6d
