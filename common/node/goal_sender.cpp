// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/goal_sender.hpp"

#include <algorithm>

namespace nodmap::node {
namespace {

constexpr time::Duration kGoalPeriod = 1s;

}  // namespace

void GoalSender::set(nodmap::goal_t goal, time::Timestamp now) {
  goal.utime = std::max(time::to_utime(now), goal_.utime + 1);
  goal.goal_seq = goal_.goal_seq;
  goal.is_active = 1;
  goal_ = goal;
  own_.push_back(goal);
  publish(now);
}

void GoalSender::repeat_if_due(time::Timestamp now) {
  if (published_ && time::is_due(now, published_, kGoalPeriod)) {
    publish(now);
  }
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
