// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/goal_sender.hpp"

#include <algorithm>
#include <utility>

#include "common/node/messages.hpp"

namespace nodmap::node {
namespace {

constexpr time::Duration kGoalPeriod = 1s;
// A navigator that was silent for this long may have been started anew, and then has no goal.
constexpr time::Duration kNavigatorSilence = 1s;

}  // namespace

void GoalSender::set(nodmap::goal_t goal, time::Timestamp now) {
  decide(goal, true, now);
}

void GoalSender::cancel(time::Timestamp now) {
  decide({}, false, now);
}

void GoalSender::decide(nodmap::goal_t goal, bool is_active, time::Timestamp now) {
  goal.utime = std::max(time::to_utime(now), goal_.utime + 1);
  goal.goal_seq = goal_.goal_seq;
  goal.is_active = static_cast<std::int8_t>(is_active);
  goal_ = goal;
  own_.push_back(goal);
  status_ = Status::kSent;
  publish(now);
}

void GoalSender::repeat_if_due(time::Timestamp now) {
  if (status_ != Status::kNone && status_ != Status::kOverruled &&
      time::is_due(now, published_, kGoalPeriod)) {
    publish(now);
  }
}

bool GoalSender::take(const nodmap::goal_t& message) {
  if (is_own(message)) {
    return false;
  }
  if (status_ != Status::kNone) {
    status_ = Status::kOverruled;
  }
  return true;
}

bool GoalSender::take(const nodmap::navigation_t& message) {
  const time::Timestamp now = stamp_of(message);
  const bool was_silent = time::is_due(now, std::exchange(reported_, now), kNavigatorSilence);
  if (status_ == Status::kTaken && was_silent) {
    status_ = Status::kSent;
  }
  const bool is_report_on_it = is_about(message.goal_utime);
  if (is_report_on_it && status_ != Status::kOverruled) {
    status_ = Status::kTaken;
  } else if (!is_report_on_it && status_ == Status::kTaken) {
    status_ = Status::kLeft;
  }
  return is_report_on_it;
}

void GoalSender::publish(time::Timestamp now) {
  published_ = now;
  bus_.publish("GOAL", goal_);
  ++goal_.goal_seq;
}

bool GoalSender::is_own(const nodmap::goal_t& message) const {
  return std::ranges::any_of(own_, [&](const nodmap::goal_t& own) {
    return own.utime == message.utime && own.is_active == message.is_active &&
           std::ranges::equal(own.position_m, message.position_m);
  });
}

}  // namespace nodmap::node
