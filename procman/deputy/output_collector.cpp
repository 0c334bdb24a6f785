// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/output_collector.hpp"

#include <algorithm>
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
  Stream& stream = streams_[id];
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
  for (const char c : text) {
    if (c != '\0') {  // would end the text for whoever receives it
      found->text += c;
    }
  }
  pending_bytes_ += text.size();
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
  const bool is_due = now_us - published_us_ >= kPeriodUs || pending_bytes_ > kPromptBytes;
  if (pending_.empty() || !is_due) {
    return {};
  }
  published_us_ = now_us;
  pending_bytes_ = 0;
  return std::exchange(pending_, {});
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
