// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/sender_watch.hpp"

#include <limits>

namespace nodmap::node {
namespace {

constexpr time::Duration kWindow = 1s;

/// Whether `seq` continues the sequence after `last`, allowing for lost messages. The numbers may
/// be anything, so no sum or difference that could overflow is computed.
bool continues(std::int64_t last, std::int64_t seq) {
  constexpr std::int64_t kGreatest = std::numeric_limits<std::int64_t>::max();
  return seq > last &&
         (last > kGreatest - SenderWatch::kLargestStep || seq <= last + SenderWatch::kLargestStep);
}

}  // namespace

bool SenderWatch::follow(std::int64_t seq, time::SteadyTime now) {
  if (followed_ && now < followed_->at) {
    *this = SenderWatch();
  }
  const bool is_alive = followed_ && now - followed_->at < kSilence;
  if (is_alive && !continues(followed_->seq, seq)) {
    count_stranger(now);
    return false;
  }
  if (!is_alive) {
    strangers_ = 0;  // they were messages of the newly accepted sender
  } else if (now - window_begin_ < kWindow && strangers_ >= kStrangersOfASecondSender) {
    contested_since_ = now;
  }
  followed_ = {seq, now};
  return true;
}

void SenderWatch::count_stranger(time::SteadyTime now) {
  if (now - window_begin_ >= kWindow) {
    window_begin_ = now;
    strangers_ = 0;
  }
  ++strangers_;
}

}  // namespace nodmap::node
