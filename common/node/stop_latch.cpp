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

StopLatch::Change StopLatch::take(const nodmap::stop_t& message) {
  const Decision decision{message.utime, read_name(message.requested_by)};
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
  const Change change = stop(decision.by);
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
