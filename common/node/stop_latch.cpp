// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/stop_latch.hpp"

#include <algorithm>
#include <utility>

#include "common/node/messages.hpp"
#include "common/node/process_names.hpp"

namespace nodmap::node {

std::string confirmed_name(const std::string& by) {
  return std::string(kBaseDriver) + ", for " + by;
}

bool is_confirmation(const nodmap::stop_t& message) {
  return message.is_stopped != 0 && message.requested_by.starts_with(confirmed_name(""));
}

// The base driver of another robot, or a second one of this: what it repeats was asked for by
// somebody. Two would otherwise name each other, once more each second.
std::string StopLatch::named_in(std::string by) {
  const std::string prefix = confirmed_name("");
  while (by.starts_with(prefix)) {
    by.erase(0, prefix.size());
  }
  return by;
}

StopLatch::Decision StopLatch::decision_of(const nodmap::stop_t& message) {
  return {message.utime, read_name(message.requested_by)};
}

bool StopLatch::is_new_release(const nodmap::stop_t& message) const {
  return message.is_stopped == 0 &&
         std::ranges::find(releases_, decision_of(message)) == releases_.end();
}

StopLatch::Change StopLatch::take(const nodmap::stop_t& message) {
  const Decision decision = decision_of(message);
  if (message.is_stopped == 0) {
    return release(decision);
  }
  const bool is_repeated = !is_base_driver_ && (is_confirmation(message) || decision == last_stop_);
  if (is_repeated && is_stopped() && !is_only_repeated_) {
    return Change::kNone;
  }
  if (!is_repeated) {
    last_stop_ = decision;
  }
  const Change change = stop(is_base_driver_ ? named_in(decision.by) : decision.by);
  is_only_repeated_ = is_repeated;
  return change;
}

StopLatch::Change StopLatch::stop(std::string by) {
  const bool was_stopped = is_stopped();
  stopped_by_ = std::move(by);
  is_only_repeated_ = false;
  return was_stopped ? Change::kNone : Change::kStopped;
}

StopLatch::Change StopLatch::release(const Decision& decision) {
  const bool is_copy = std::ranges::find(releases_, decision) != releases_.end();
  if (!is_copy) {
    releases_.push_back(decision);
  }
  if (!is_stopped() || (is_copy && !is_only_repeated_)) {
    return Change::kNone;
  }
  stopped_by_.reset();
  return Change::kReleased;
}

}  // namespace nodmap::node
