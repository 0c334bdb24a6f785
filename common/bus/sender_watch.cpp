// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/sender_watch.hpp"

namespace nodmap::bus {

bool SenderWatch::follow(const Sender& sender, time::SteadyTime now) {
  if (!followed_.is_alive(now)) {
    strangers_ = 0;  // they were messages of the newly accepted sender
    if (contested_since_ && now < *contested_since_) {
      contested_since_.reset();  // the clock was set back
    }
  }
  if (!followed_.follow(sender, now)) {
    count_stranger(now);
    return false;
  }
  if (strangers_ >= strangers_needed_ && now - window_begin_ < contested_) {
    contested_since_ = last_stranger_;
  }
  return true;
}

void SenderWatch::refuse(const Sender& sender, time::SteadyTime now) {
  if (followed_.is_alive(now) && sender != followed_.sender()) {
    count_stranger(now);
  }
}

void SenderWatch::count_stranger(time::SteadyTime now) {
  if (strangers_ == 0 || now - window_begin_ >= contested_) {
    window_begin_ = now;
    strangers_ = 0;
  }
  ++strangers_;
  last_stranger_ = now;
}

}  // namespace nodmap::bus
