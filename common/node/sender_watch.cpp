// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/sender_watch.hpp"

#include <algorithm>
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

bool SenderWatch::follow(std::int64_t seq, time::SteadyTime now, const bus::Sender& sender) {
  if (!is_alive(now)) {
    strangers_ = 0;  // they were messages of the newly accepted sender
    skipped_after_ = seq;
    refused_.reset();
    followed_ = {seq, now, sender};
    return true;
  }
  if (!is_next(seq, sender)) {
    refuse_stranger(seq, now);
    return false;
  }
  if (refused_ && seq <= *refused_) {
    count_stranger(now);
  }
  refused_.reset();
  contest_if_several(now);
  if (now - skipped_at_ >= kWindow) {
    skipped_after_ = followed_->seq;
  }
  if (seq - 1 > followed_->seq) {
    skipped_at_ = now;
  }
  followed_ = {seq, now, sender};
  return true;
}

void SenderWatch::refuse(std::int64_t seq, time::SteadyTime now, const bus::Sender& sender) {
  if (!is_alive(now)) {
    return;
  }
  if (is_next(seq, sender)) {
    refused_ = std::max(refused_.value_or(seq), seq);
  } else {
    refuse_stranger(seq, now);
  }
}

/// Whether a sender is accepted and has been heard recently.
bool SenderWatch::is_alive(time::SteadyTime now) {
  if (followed_ && now < followed_->at) {
    *this = SenderWatch();
  }
  return followed_ && now - followed_->at < kSilence;
}

/// Whether a message can be from the accepted sender, which is alive.
bool SenderWatch::is_next(std::int64_t seq, const bus::Sender& sender) const {
  return sender == followed_->sender && continues(followed_->seq, seq);
}

void SenderWatch::refuse_stranger(std::int64_t seq, time::SteadyTime now) {
  count_stranger(now);
  if (seq > skipped_after_ && seq <= followed_->seq) {
    contest_if_several(now);
  }
}

void SenderWatch::count_stranger(time::SteadyTime now) {
  if (now - window_begin_ >= kWindow) {
    window_begin_ = now;
    strangers_ = 0;
  }
  ++strangers_;
}

void SenderWatch::contest_if_several(time::SteadyTime now) {
  if (now - window_begin_ < kWindow && strangers_ >= kStrangersOfASecondSender) {
    contested_since_ = now;
  }
}

}  // namespace nodmap::node
