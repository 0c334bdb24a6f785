// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/sender_watch.hpp"

#include <limits>

namespace nodmap::node {
namespace {

constexpr std::int64_t kWindowUs = 1'000'000;

/// Whether `seq` may follow `last` when some messages between were lost. Any numbers may come: no
/// sum or difference is taken that could overflow.
bool continues(std::int64_t last, std::int64_t seq) {
  constexpr std::int64_t kGreatest = std::numeric_limits<std::int64_t>::max();
  return seq > last &&
         (last > kGreatest - SenderWatch::kLargestStep || seq <= last + SenderWatch::kLargestStep);
}

}  // namespace

bool SenderWatch::follow(std::int64_t seq, std::int64_t now_us) {
  if (followed_ && now_us < followed_->at_us) {
    *this = SenderWatch();
  }
  const bool is_alive = followed_ && now_us - followed_->at_us < kSilenceUs;
  if (is_alive && !continues(followed_->seq, seq)) {
    count_stranger(now_us);
    return false;
  }
  if (!is_alive) {
    strangers_ = 0;  // they were messages of the sender that is followed from now on
  } else if (now_us - window_begin_us_ < kWindowUs && strangers_ >= kStrangersOfASecondSender) {
    contested_since_us_ = now_us;
  }
  followed_ = {seq, now_us};
  return true;
}

void SenderWatch::count_stranger(std::int64_t now_us) {
  if (now_us - window_begin_us_ >= kWindowUs) {
    window_begin_us_ = now_us;
    strangers_ = 0;
  }
  ++strangers_;
}

}  // namespace nodmap::node
