// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/sender_watch.hpp"

namespace nodmap::bus {

bool SenderWatch::follow(const Sender& sender, time::SteadyTime now) {
  if (!followed_.is_alive(now)) {
    strangers_.clear();  // they were messages of the newly accepted sender
    if (contested_since_ && now < *contested_since_) {
      contested_since_.reset();  // the clock was set back
    }
  }
  if (!followed_.follow(sender, now)) {
    strangers_.push_back(now);
    return false;
  }
  if (are_many_strangers()) {
    contested_since_ = strangers_.back();
  }
  return true;
}

void SenderWatch::refuse(const Sender& sender, time::SteadyTime now) {
  if (followed_.is_alive(now) && sender != followed_.sender()) {
    strangers_.push_back(now);
  }
}

}  // namespace nodmap::bus
