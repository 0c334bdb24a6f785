// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/heartbeat.hpp"

namespace nodmap::viewer {

std::optional<std::string> Heartbeat::next_ping(time::SteadyTime now) {
  if (is_waiting_ || now - sent_ < kPeriod) {
    return std::nullopt;
  }
  is_waiting_ = true;
  sent_ = now;
  return std::to_string(++number_);
}

void Heartbeat::take_pong(std::string_view payload) {
  if (is_waiting_ && payload == std::to_string(number_)) {
    is_waiting_ = false;
    answered_ = sent_;
  }
}

}  // namespace nodmap::viewer
