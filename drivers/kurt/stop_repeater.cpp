// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/stop_repeater.hpp"

#include "common/node/stop_latch.hpp"

namespace nodmap::kurt {
namespace {

constexpr time::Duration kStopPeriod = 1s;

}  // namespace

std::optional<nodmap::stop_t> StopRepeater::repeat_if_due(
    const std::optional<std::string>& stopped_by, const time::Moment& now) {
  if (!stopped_by) {
    next_.reset();
    return std::nullopt;
  }
  if (!next_ || now.steady < *next_) {
    next_ = next_.value_or(now.steady + kStopPeriod);
    return std::nullopt;
  }
  next_ = now.steady + kStopPeriod;
  nodmap::stop_t message{};
  message.utime = time::to_utime(now.wall);
  message.stop_seq = num_repeated_++;
  message.is_stopped = 1;
  message.requested_by = node::confirmed_name(*stopped_by);
  last_ = message;
  return message;
}

bool StopRepeater::is_own(const nodmap::stop_t& message) const {
  return last_ && message.is_stopped != 0 && message.utime == last_->utime &&
         message.requested_by == last_->requested_by;
}

}  // namespace nodmap::kurt
