// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/stop_state.hpp"

#include "common/node/messages.hpp"
#include "common/node/stop_latch.hpp"

namespace nodmap::foxglove {
namespace {

// Two confirmations are missing.
constexpr time::Duration kPatience = 2500ms;

const char* name_of(StopState::State state) {
  switch (state) {
    case StopState::State::kReleased:
      return "RELEASED";
    case StopState::State::kSent:
      return "SENT";
    case StopState::State::kStopped:
      return "STOPPED";
    case StopState::State::kNotConfirmed:
      return "NOT_CONFIRMED";
  }
  return "";
}

}  // namespace

void StopState::take(const nodmap::stop_t& message, time::SteadyTime arrived) {
  stamp_ = node::stamp_of(message);
  now_ = arrived;
  const bool is_confirmed = node::is_confirmation(message);
  if (message.is_stopped == 0) {
    asked_.reset();
    confirmed_.reset();
  } else {
    asked_ = asked_.value_or(arrived);
  }
  if (is_confirmed) {
    confirmed_ = arrived;
  }
  // What the base driver says does not alternate with the repetitions of others.
  if (is_confirmed || state() != State::kStopped) {
    by_ = node::read_name(message.requested_by);
  }
}

bool StopState::pass(time::SteadyTime now) {
  const State before = state();
  now_ = now;
  return state() != before;
}

StopState::State StopState::state() const {
  if (!asked_) {
    return State::kReleased;
  }
  if (now_ - confirmed_.value_or(*asked_) >= kPatience) {
    return State::kNotConfirmed;
  }
  return confirmed_ ? State::kStopped : State::kSent;
}

Json StopState::to_json() const {
  return {{"timestamp", time_json(stamp_)}, {"state", name_of(state())}, {"by", by_}};
}

}  // namespace nodmap::foxglove
