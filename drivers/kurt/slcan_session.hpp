// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/geometry/time.hpp"
#include "drivers/kurt/slcan.hpp"

namespace nodmap::kurt {

/// Opens the CAN bus on an SLCAN adapter in any state, and notices when the adapter falls off it.
/// Pure: lines and times in, text to send out. Times are microseconds of one monotonic clock.
class SlcanSession {
 public:
  /// The port has just been opened.
  void start(time::SteadyTime now);

  /// The port is gone.
  void stop() { state_ = State::kStopped; }

  /// Takes a line from the adapter.
  void take(const SlcanLine& line, time::SteadyTime now);

  /// What to send now; often nothing. To be asked every 10 ms or so.
  [[nodiscard]] std::string poll(time::SteadyTime now);

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

  [[nodiscard]] std::string enter(State state, time::SteadyTime now);
  [[nodiscard]] std::string close_channel(time::SteadyTime now);
  [[nodiscard]] std::string restart(time::SteadyTime now);
  [[nodiscard]] std::string poll_open(time::SteadyTime now);

  State state_ = State::kStopped;
  enum class Answer : std::uint8_t { kNone, kDone, kRefused };
  Answer answer_ = Answer::kNone;
  time::SteadyTime entered_;
  time::SteadyTime last_frame_;
  time::SteadyTime flags_asked_;
  int attempts_ = 0;
  int refused_in_a_row_ = 0;
  std::uint8_t flags_ = 0;
  std::int64_t restarts_ = 0;
  bool greeted_ = false;
};

}  // namespace nodmap::kurt
