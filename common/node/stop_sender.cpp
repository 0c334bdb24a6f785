// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/stop_sender.hpp"

#include <algorithm>
#include <cstdint>

#include "common/node/messages.hpp"

namespace nodmap::node {

StopSender::StopSender(bus::Bus& bus, std::string requested_by) : bus_(bus) {
  message_.stop_seq = -1;
  message_.requested_by = std::move(requested_by);
}

void StopSender::decide(bool is_stopped, time::Timestamp now) {
  message_.utime = time::to_utime(now);
  message_.is_stopped = static_cast<std::int8_t>(is_stopped);
  num_sent_ = 0;
  confirmed_by_.reset();
  latch_.take(message_);
  publish(now);
}

void StopSender::repeat_if_due(time::Timestamp now) {
  const bool is_wanted = message_.is_stopped != 0 || !is_sent();
  if (is_wanted && time::is_due(now, sent_, kPeriod)) {
    publish(now);
  }
}

void StopSender::take(const nodmap::stop_t& message) {
  const bool has_been_released = latch_.take(message) == StopLatch::Change::kReleased;
  if (is_confirmation(message)) {
    confirmed_by_ = read_name(message.requested_by);
  } else if (has_been_released && message_.is_stopped != 0) {
    // By somebody else: otherwise two senders would contradict each other.
    message_.is_stopped = 0;
    num_sent_ = kNumCopies;
    confirmed_by_.reset();
  }
}

void StopSender::publish(time::Timestamp now) {
  if (message_.is_stopped == 0) {
    confirmed_by_.reset();
  }
  sent_ = now;
  num_sent_ = std::min(num_sent_ + 1, kNumCopies);
  ++message_.stop_seq;
  bus_.publish("STOP", message_);
}

}  // namespace nodmap::node
