// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/laser3d/bytes.hpp"

namespace nodmap::laser3d {

/// Where the laser pointed at one moment.
struct PitchSample {
  std::int64_t time_us = 0;
  double pitch_rad = 0.0;   ///< positive looks up
  double rate_rad_s = 0.0;  ///< positive: upwards
};

struct ServoOutput {
  Bytes send;
  std::optional<PitchSample> sample;
};

/// What went wrong on the servo's line.
struct ServoCounts {
  std::int64_t unanswered = 0;       ///< requests
  std::int64_t damaged = 0;          ///< requests that the servo says arrived damaged
  std::int64_t checksum_errors = 0;  ///< of answers
  std::int64_t implausible = 0;      ///< positions where the head cannot be
};

/// The conversation with a pitch servo, whatever it speaks: brings it up, moves it, and tells where
/// it is, again and again. Pure state machines; all times are microseconds of one clock that never
/// steps.
class ServoSession {
 public:
  ServoSession() = default;
  ServoSession(const ServoSession&) = delete;
  ServoSession& operator=(const ServoSession&) = delete;
  ServoSession(ServoSession&&) = delete;
  ServoSession& operator=(ServoSession&&) = delete;
  virtual ~ServoSession() = default;

  /// The line has been opened.
  [[nodiscard]] virtual ServoOutput open(std::int64_t now_us) = 0;
  /// The line is gone.
  virtual void close() = 0;
  /// To be called at least every few milliseconds.
  [[nodiscard]] virtual ServoOutput poll(std::int64_t now_us) = 0;
  [[nodiscard]] virtual ServoOutput receive(ByteView bytes, std::int64_t now_us) = 0;
  /// Where to go, and how fast: sent with the next poll().
  virtual void aim(double goal_rad, double speed_rad_s) = 0;

  /// Whether it moves and tells where it is.
  [[nodiscard]] virtual bool running() const = 0;
  /// Whether the pitch it tells was measured, or is only what was commanded.
  [[nodiscard]] virtual bool measures_pitch() const = 0;
  /// All zero for a servo that does not answer.
  [[nodiscard]] virtual ServoCounts line_counts() const { return {}; }
  /// Why it is not running; empty when it is.
  [[nodiscard]] virtual const std::string& trouble() const = 0;
};

}  // namespace nodmap::laser3d
