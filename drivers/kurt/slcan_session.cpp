// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/slcan_session.hpp"

namespace nodmap::kurt {
namespace {

/// What the adapter says in this time after the closing belongs to what was before.
constexpr std::int64_t kSettleUs = 100'000;
constexpr std::int64_t kAnswerTimeoutUs = 200'000;
/// The base sends its encoders every 10 ms: 50 of them missing in a row is no accident.
constexpr std::int64_t kMuteUs = 500'000;
constexpr std::int64_t kFlagsPeriodUs = 1'000'000;
constexpr int kMaxAttempts = 3;
/// An adapter that was reset by itself refuses every frame, for its channel is closed.
constexpr int kMaxRefusedInARow = 10;

}  // namespace

void SlcanSession::start(std::int64_t now_us) {
  state_ = State::kClosing;
  entered_us_ = now_us;
  attempts_ = 0;
  flags_ = 0;
  greeted_ = false;
}

std::string SlcanSession::enter(State state, std::int64_t now_us) {
  state_ = state;
  entered_us_ = now_us;
  answer_ = Answer::kNone;
  switch (state) {
    case State::kSettingRate:
      return "S8\r";  // 1 Mbit/s
    case State::kOpening:
      return "O\r";
    case State::kOpen:
      last_frame_us_ = now_us;
      flags_asked_us_ = now_us;
      refused_in_a_row_ = 0;
      return "";
    case State::kStopped:
    case State::kClosing:
    case State::kGaveUp:
      break;
  }
  return "";
}

std::string SlcanSession::close_channel(std::int64_t now_us) {
  greeted_ = true;
  // Empty lines first: they end whatever a former program left half written.
  return enter(State::kClosing, now_us) + "\r\r\rC\r";
}

std::string SlcanSession::restart(std::int64_t now_us) {
  ++restarts_;
  if (++attempts_ >= kMaxAttempts) {
    return enter(State::kGaveUp, now_us);
  }
  return close_channel(now_us);
}

void SlcanSession::take(const SlcanLine& line, std::int64_t now_us) {
  switch (line.kind) {
    case SlcanLine::Kind::kFrame:
      last_frame_us_ = now_us;
      if (is_open()) {
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
      break;
  }
}

std::string SlcanSession::poll(std::int64_t now_us) {
  const std::int64_t waited_us = now_us - entered_us_;
  switch (state_) {
    case State::kStopped:
    case State::kGaveUp:
      return "";
    case State::kClosing:
      if (!greeted_) {
        return close_channel(now_us);
      }
      return waited_us >= kSettleUs ? enter(State::kSettingRate, now_us) : "";
    case State::kSettingRate:
    case State::kOpening:
      if (answer_ == Answer::kDone) {
        return enter(state_ == State::kSettingRate ? State::kOpening : State::kOpen, now_us);
      }
      return answer_ == Answer::kRefused || waited_us >= kAnswerTimeoutUs ? restart(now_us) : "";
    case State::kOpen:
      return poll_open(now_us);
  }
  return "";
}

std::string SlcanSession::poll_open(std::int64_t now_us) {
  if (now_us - last_frame_us_ >= kMuteUs || refused_in_a_row_ >= kMaxRefusedInARow) {
    return restart(now_us);
  }
  if (now_us - flags_asked_us_ >= kFlagsPeriodUs) {
    flags_asked_us_ = now_us;
    return "F\r";
  }
  return "";
}

}  // namespace nodmap::kurt
