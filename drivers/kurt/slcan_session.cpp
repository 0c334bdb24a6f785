// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/slcan_session.hpp"

namespace nodmap::kurt {
namespace {

constexpr time::Duration kAnswerTimeout = 200ms;
// The base sends its encoder ticks every 10 ms; 50 missing in a row are not an accident.
constexpr time::Duration kMute = 500ms;
constexpr time::Duration kQuestionPeriod = 1s;
// In time is an answer within twice what a sound line takes: 16 ms to and from a USB adapter with
// the default latency, and a period until the driver looks. Within 70 ms the robot drives 0.13 m at
// 1.8 m/s, and its navigator halts by itself when odometry is 100 ms older than a scan.
constexpr time::Duration kInTime = 70ms;
// Three frames of the base are missing, or late: the line is asked at once, not within a second.
constexpr time::Duration kDoubtful = 40ms;
constexpr time::Duration kDoubtfulPeriod = 100ms;
// An answer that has not come now will not: it, or the question, was damaged. Answers that are so
// late do not occur, because at kMute the bus is opened anew.
constexpr time::Duration kUnanswered = kMute;
constexpr int kMaxAttempts = 3;
// An adapter that has reset itself refuses every frame, because its channel is closed.
constexpr int kMaxRefusedInARow = 10;

}  // namespace

void SlcanSession::start(time::SteadyTime now) {
  state_ = State::kClosing;
  entered_ = now;
  attempts_ = 0;
  flags_ = 0;
  flags_missing_ = 0;
  greeted_ = false;
}

std::string SlcanSession::enter(State state, time::SteadyTime now) {
  state_ = state;
  entered_ = now;
  answer_ = Answer::kNone;
  switch (state) {
    case State::kSettingRate:
      return "S8\r";  // 1 Mbit/s
    case State::kOpening:
      return "O\r";
    case State::kOpen:
      last_frame_ = now;
      asked_ = now;
      is_asked_ = false;
      is_unanswered_ = false;
      is_overdue_ = false;
      is_doubted_ = false;
      delay_ = {};
      refused_in_a_row_ = 0;
      return "";
    case State::kStopped:
    case State::kClosing:
    case State::kGaveUp:
      break;
  }
  return "";
}

std::string SlcanSession::close_channel(time::SteadyTime now) {
  greeted_ = true;
  // Empty lines first: they end a command that a previous program left incomplete.
  return enter(State::kClosing, now) + "\r\r\rC\r";
}

std::string SlcanSession::restart(time::SteadyTime now) {
  ++restarts_;
  // Without a base nobody acknowledges our frames, and the adapter may refuse more of them.
  is_mute_ = is_open() && (now - last_frame_ >= kMute || last_frame_ == entered_);
  if (++attempts_ >= kMaxAttempts) {
    return enter(State::kGaveUp, now);
  }
  return close_channel(now);
}

void SlcanSession::take(const SlcanLine& line, time::SteadyTime now) {
  switch (line.kind) {
    case SlcanLine::Kind::kFrame:
      last_frame_ = now;
      if (is_open()) {
        is_mute_ = false;
        attempts_ = 0;
      }
      break;
    case SlcanLine::Kind::kDone:
      answer_ = Answer::kDone;
      refused_in_a_row_ = 0;
      break;
    case SlcanLine::Kind::kRefused:
      answer_ = Answer::kRefused;
      ++refused_in_a_row_;
      break;
    case SlcanLine::Kind::kFlags:
      flags_ = line.flags;
      flags_missing_ = 0;
      take_answer(Question::kFlags, now);
      break;
    case SlcanLine::Kind::kVersion:
      take_answer(Question::kVersion, now);
      break;
  }
}

std::string SlcanSession::poll(time::SteadyTime now) {
  const time::Duration waited = now - entered_;
  switch (state_) {
    case State::kStopped:
    case State::kGaveUp:
      return "";
    case State::kClosing:
      if (!greeted_) {
        return close_channel(now);
      }
      return waited >= kSettle ? enter(State::kSettingRate, now) : "";
    case State::kSettingRate:
    case State::kOpening:
      if (answer_ == Answer::kDone) {
        return enter(state_ == State::kSettingRate ? State::kOpening : State::kOpen, now);
      }
      return answer_ == Answer::kRefused || waited >= kAnswerTimeout ? restart(now) : "";
    case State::kOpen:
      return poll_open(now);
  }
  return "";
}

std::string SlcanSession::poll_open(time::SteadyTime now) {
  if (now - last_frame_ >= kMute || refused_in_a_row_ >= kMaxRefusedInARow) {
    return restart(now);
  }
  watch_answer(now);
  const time::Duration pause = is_asked_     ? kUnanswered
                               : is_doubted_ ? kDoubtfulPeriod
                                             : kQuestionPeriod;
  if (now - asked_ < pause) {
    return "";
  }
  question_ = next_question();
  is_unanswered_ = is_asked_;
  is_doubted_ = is_doubted_ || is_asked_;
  asked_ = now;
  is_asked_ = true;
  is_overdue_ = false;
  return question_ == Question::kFlags ? "F\r" : "V\r";
}

// The version if the flags were not told, which may have been an accident.
SlcanSession::Question SlcanSession::next_question() const {
  const bool are_flags_missing = is_asked_ && question_ == Question::kFlags;
  return lacks_flags() || are_flags_missing ? Question::kVersion : Question::kFlags;
}

// A single answer may be lost, so one that does not come makes the line late only while frames of
// the base are missing, too, or when the one before it did not come either.
void SlcanSession::watch_answer(time::SteadyTime now) {
  const time::Duration waited = now - asked_;
  is_doubted_ = is_doubted_ || now - last_frame_ >= kDoubtful;
  if (!is_asked_ || waited <= kInTime) {
    return;
  }
  is_overdue_ = true;
  if (is_doubted_) {
    delay_ = waited;
  }
}

// An answer is in time unless poll() has looked for it in vain after its time: if this process was
// not scheduled, the answer may have waited for it.
void SlcanSession::take_answer(Question question, time::SteadyTime now) {
  if (!is_asked_ || question != question_) {
    return;
  }
  if (question == Question::kVersion) {
    ++flags_missing_;  // because it is asked only if they are
  }
  is_asked_ = false;
  is_unanswered_ = false;
  is_doubted_ = is_overdue_;
  delay_ = is_overdue_ ? now - asked_ : 0us;
}

}  // namespace nodmap::kurt
