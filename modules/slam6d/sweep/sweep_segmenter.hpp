// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/scan/scan.hpp"

namespace nodmap::slam6d {

/// The scans of one complete pitch movement (IV B), in order of arrival.
struct Sweep {
  enum class End : std::uint8_t {
    kReversal,     ///< the pitch changed direction
    kJumpBack,     ///< the pitch went back in one step: a scanner that sweeps one way only
    kInterrupted,  ///< a pause, or stamps that step back
    kFull,         ///< as many scans as a sweep may have
    kFlushed       ///< the end of the recording
  };

  std::vector<scan::Scan> scans;
  End end = End::kFlushed;
  /// Whether the stream was interrupted before the first scan, so that the motion in between is
  /// unknown.
  bool follows_interruption = false;
};

/// How the stream of scans is divided into sweeps, and which sweeps are used.
struct SweepParams {
  double reversal_hysteresis_rad = geometry::deg_to_rad(1.0);
  double jump_back_rad = geometry::deg_to_rad(10.0);
  double gap_s = 1.0;
  int max_scans = 1500;
  int min_scans = 10;

  template <class Visitor>
  void describe(Visitor& v) {
    v.angle("reversal_hysteresis_deg", reversal_hysteresis_rad, {0.01, 45.0},
            "A sweep ends at a reversal once the pitch has come back from it by this much. Must "
            "exceed the noise of the servo.");
    v.angle("jump_back_deg", jump_back_rad, {1.0, 180.0},
            "A single pitch step against the movement by more than this begins a new sweep in the "
            "same direction: it is not a reversal.");
    v.number(
        "gap_s", gap_s, {0.05, 3600.0},
        "A pause of more than this between two scans interrupts the stream and ends the sweep.");
    v.integer("max_scans", max_scans, {2, 100000}, "A sweep ends when it has this many scans.");
    v.integer("min_scans", min_scans, {1, 1000},
              "A sweep with fewer scans is too thin to be registered.");
  }
};

/// Divides the stream of scans at the reversals of the pitch (IV B). Every scan belongs to exactly
/// one sweep; scans during which the pitch is constant belong to the running sweep.
class SweepSegmenter {
 public:
  explicit SweepSegmenter(const SweepParams& params) : params_(params) {}

  /// Takes the next scan. Returns a sweep once it is known to be complete.
  [[nodiscard]] std::optional<Sweep> add(scan::Scan scan);

  /// The unfinished sweep at the end of the stream.
  [[nodiscard]] std::optional<Sweep> flush();

 private:
  [[nodiscard]] std::optional<Sweep::End> end_before(const scan::Scan& next) const;
  [[nodiscard]] Sweep cut(std::size_t num_scans, Sweep::End end);
  void track(double pitch_rad, std::size_t num_scans);

  // The extreme pitch in one direction, and how many scans of the sweep led to it.
  struct Extreme {
    double pitch_rad = 0.0;
    std::size_t num_scans = 0;
  };

  SweepParams params_;
  Sweep running_;
  int direction_ = 0;  // of the pitch: +1 up, -1 down, 0 not known yet
  Extreme highest_;
  Extreme lowest_;
};

}  // namespace nodmap::slam6d
