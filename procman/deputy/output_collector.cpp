// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/output_collector.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace nodmap::procman {

std::size_t TokenBucket::take(std::size_t wanted, std::int64_t now_us) {
  const std::int64_t elapsed_us = now_us - filled_us_.value_or(now_us);
  filled_us_ = now_us;
  tokens_ = std::min(burst_bytes_, tokens_ + bytes_per_s_ * static_cast<double>(elapsed_us) * 1e-6);
  const std::size_t taken = std::min(wanted, static_cast<std::size_t>(std::max(0.0, tokens_)));
  tokens_ -= static_cast<double>(taken);
  return taken;
}

void OutputCollector::add(const std::string& id, std::string_view text, std::int64_t now_us) {
  // Orders may name commands without end: what is said of those over the limit is limited together.
  const bool is_too_many = streams_.size() >= kMaxStreams && !streams_.contains(id);
  Stream& stream = streams_[is_too_many ? std::string() : id];
  const std::size_t of_command = stream.bucket.take(text.size(), now_us);
  const std::size_t passing = total_.take(of_command, now_us);
  stream.bucket.give_back(of_command - passing);
  append(id, text.substr(0, passing));
  const auto dropped = static_cast<std::int64_t>(text.size() - passing);
  dropped_bytes_ += dropped;
  stream.unsaid_bytes += dropped;
}

void OutputCollector::append(const std::string& id, std::string_view text) {
  if (text.empty()) {
    return;
  }
  auto found = std::find_if(pending_.begin(), pending_.end(),
                            [&id](const Said& said) { return said.command_id == id; });
  if (found == pending_.end()) {
    found = pending_.insert(pending_.end(), {id, {}});
  }
  const std::size_t before = found->text.size();
  // A zero byte would end the text for whoever receives it.
  std::copy_if(text.begin(), text.end(), std::back_inserter(found->text),
               [](char c) { return c != '\0'; });
  pending_bytes_ += found->text.size() - before;
}

void OutputCollector::complain(std::int64_t now_us) {
  for (auto& [id, stream] : streams_) {
    if (stream.unsaid_bytes > 0 && now_us - stream.complained_us >= kComplaintPeriodUs) {
      append(id, "\n[nodmap-deputy: " + std::to_string(stream.unsaid_bytes) +
                     " bytes of output dropped]\n");
      stream.unsaid_bytes = 0;
      stream.complained_us = now_us;
    }
  }
}

std::vector<Said> OutputCollector::take(std::int64_t now_us) {
  complain(now_us);
  const bool is_prompt = pending_bytes_ > kPromptBytes && !is_rest_;
  if (pending_.empty() || (now_us - published_us_ < kPeriodUs && !is_prompt)) {
    return {};
  }
  published_us_ = now_us;
  std::vector<Said> message = take_front(kMaxMessageBytes);
  is_rest_ = !pending_.empty();
  return message;
}

/// `room` bytes of what is pending, the short texts first: a flood makes nobody else wait.
std::vector<Said> OutputCollector::take_front(std::size_t room) {
  if (pending_bytes_ > room) {
    std::stable_sort(pending_.begin(), pending_.end(),
                     [](const Said& a, const Said& b) { return a.text.size() < b.text.size(); });
  }
  std::vector<Said> front;
  while (!pending_.empty() && room > 0) {
    Said& said = pending_.front();
    const std::size_t size = std::min(room, said.text.size());
    front.push_back({said.command_id, said.text.substr(0, size)});
    said.text.erase(0, size);
    room -= size;
    pending_bytes_ -= size;
    if (said.text.empty()) {
      pending_.erase(pending_.begin());
    }
  }
  return front;
}

std::optional<std::int64_t> OutputCollector::due_us() const {
  std::optional<std::int64_t> due;
  if (!pending_.empty()) {
    due = published_us_ + kPeriodUs;
  }
  for (const auto& [id, stream] : streams_) {
    if (stream.unsaid_bytes > 0) {
      const std::int64_t complaint_us = stream.complained_us + kComplaintPeriodUs;
      due = std::min(due.value_or(complaint_us), complaint_us);
    }
  }
  return due;
}

}  // namespace nodmap::procman
