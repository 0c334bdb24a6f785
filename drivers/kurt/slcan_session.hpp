// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/geometry/time.hpp"
#include "drivers/kurt/slcan.hpp"

namespace nodmap::kurt {

/// Opens the CAN bus on an SLCAN adapter in any state, and detects when the adapter leaves the bus.
/// Measures by the adapter's answers how late its line is. A pure state machine: lines and times
/// in, text to send out.
class SlcanSession {
 public:
  /// Lines received within this time after closing belong to the previous session and are ignored.
  static constexpr time::Duration kSettle = 100ms;

  /// To be called when the port has been opened.
  void start(time::SteadyTime now);

  /// To be called when the port is gone.
  void stop() { state_ = State::kStopped; }

  /// Takes a line from the adapter.
  void take(const SlcanLine& line, time::SteadyTime now);

  /// The text to send now, often empty. To be called about every 10 ms.
  [[nodiscard]] std::string poll(time::SteadyTime now);

  /// Whether frames can be sent and received.
  [[nodiscard]] bool is_open() const { return state_ == State::kOpen; }

  /// Whether the adapter opened the bus the last time, but then no frame came: the base is silent.
  [[nodiscard]] bool is_mute() const { return is_mute_; }

  /// Whether opening the bus has failed so often that the port itself should be reopened.
  [[nodiscard]] bool gave_up() const { return state_ == State::kGaveUp; }

  /// The adapter's error flags (SlcanFlag) when last asked; 0 if it has none.
  [[nodiscard]] std::uint8_t flags() const { return flags_; }

  /// Whether the adapter answers, but not when asked for its flags.
  [[nodiscard]] bool lacks_flags() const { return flags_missing_ >= kMaxFlagsMissing; }

  /// Whether the adapter has left a question unanswered and has answered none since.
  [[nodiscard]] bool is_unanswered() const { return is_unanswered_; }

  /// How late the adapter's last answer was, or is by now; 0 if it answers in time. Frames from the
  /// bus are then as late, which they do not show.
  [[nodiscard]] time::Duration delay() const { return delay_; }

  /// How often the bus was reopened because the adapter was silent or refused commands.
  [[nodiscard]] std::int64_t restarts() const { return restarts_; }

 private:
  enum class State : std::uint8_t { kStopped, kClosing, kSettingRate, kOpening, kOpen, kGaveUp };

  [[nodiscard]] std::string enter(State state, time::SteadyTime now);
  [[nodiscard]] std::string close_channel(time::SteadyTime now);
  [[nodiscard]] std::string restart(time::SteadyTime now);
  [[nodiscard]] std::string poll_open(time::SteadyTime now);
  void watch_answer(time::SteadyTime now);
  /// What the adapter is asked to measure how late its line is. Some refuse to tell their flags;
  /// all tell their version. A refusal cannot be told from one of a frame, so it measures nothing.
  enum class Question : std::uint8_t { kFlags, kVersion };
  [[nodiscard]] Question next_question() const;
  void take_answer(Question question, time::SteadyTime now);

  static constexpr int kMaxFlagsMissing = 3;

  State state_ = State::kStopped;
  enum class Answer : std::uint8_t { kNone, kDone, kRefused };
  Answer answer_ = Answer::kNone;
  time::SteadyTime entered_;
  time::SteadyTime last_frame_;
  time::SteadyTime asked_;
  Question question_ = Question::kFlags;
  bool is_asked_ = false;    // and not answered yet
  bool is_overdue_ = false;  // the answer was not there in time, or has not come
  bool is_doubted_ = false;  // that the line is in time; then one late answer is enough
  bool is_unanswered_ = false;
  time::Duration delay_{};
  int attempts_ = 0;
  int refused_in_a_row_ = 0;
  std::uint8_t flags_ = 0;
  int flags_missing_ = 0;  // questions for the flags in a row that had no answer
  std::int64_t restarts_ = 0;
  bool greeted_ = false;
  bool is_mute_ = false;
};

}  // namespace nodmap::kurt
