// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "drivers/kurt/slcan.hpp"

namespace nodmap::kurt {

/// Opens the CAN bus on an SLCAN adapter in any state, and notices when the adapter falls off it.
/// Pure: lines and times in, text to send out. Times are microseconds of one monotonic clock.
class SlcanSession {
 public:
  /// The port has just been opened.
  void start(std::int64_t now_us);

  /// The port is gone.
  void stop() { state_ = State::kStopped; }

  /// Takes a line from the adapter.
  void take(const SlcanLine& line, std::int64_t now_us);

  /// What to send now; often nothing. To be asked every 10 ms or so.
  [[nodiscard]] std::string poll(std::int64_t now_us);

  /// Whether frames pass.
  [[nodiscard]] bool is_open() const { return state_ == State::kOpen; }

  /// Opening the bus has failed so often that the port itself should be opened anew.
  [[nodiscard]] bool gave_up() const { return state_ == State::kGaveUp; }

  /// The adapter's error flags (SlcanFlag) when last asked.
  [[nodiscard]] std::uint8_t flags() const { return flags_; }

  /// How often the bus was opened again because the adapter was mute or refused.
  [[nodiscard]] std::int64_t restarts() const { return restarts_; }

 private:
  enum class State : std::uint8_t { kStopped, kClosing, kSettingRate, kOpening, kOpen, kGaveUp };

  [[nodiscard]] std::string enter(State state, std::int64_t now_us);
  [[nodiscard]] std::string close_channel(std::int64_t now_us);
  [[nodiscard]] std::string restart(std::int64_t now_us);
  [[nodiscard]] std::string poll_open(std::int64_t now_us);

  State state_ = State::kStopped;
  enum class Answer : std::uint8_t { kNone, kDone, kRefused };
  Answer answer_ = Answer::kNone;
  std::int64_t entered_us_ = 0;
  std::int64_t last_frame_us_ = 0;
  std::int64_t flags_asked_us_ = 0;
  int attempts_ = 0;
  int refused_in_a_row_ = 0;
  std::uint8_t flags_ = 0;
  std::int64_t restarts_ = 0;
  bool greeted_ = false;
};

}  // namespace nodmap::kurt
