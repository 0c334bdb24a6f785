// SPDX-License-Identifier: BSD-3-Clause
#include "procman/deputy/output_collector.hpp"

#include <algorithm>
#include <utility>

namespace nodmap::procman {

std::size_t TokenBucket::take(std::size_t wanted, time::SteadyTime now) {
  const time::Duration elapsed = now - filled_.value_or(now);
  filled_ = now;
  tokens_ = std::min(burst_bytes_, tokens_ + bytes_per_s_ * time::seconds(elapsed));
  const std::size_t taken = std::min(wanted, static_cast<std::size_t>(std::max(0.0, tokens_)));
  tokens_ -= static_cast<double>(taken);
  return taken;
}

void OutputCollector::add(const std::string& id, std::string_view written, time::SteadyTime now) {
  std::string text(written);
  std::erase(text, '\0');  // would end the text for its receivers
  // Orders may name any number of commands; those beyond the limit share one rate limit.
  const bool is_too_many = streams_.size() >= kMaxStreams && !streams_.contains(id);
  const std::string& name = is_too_many ? std::string() : id;
  Stream& stream = streams_[name];
  stream.is_forgotten = false;
  keep_newest(stream.recent, text);
  stream.run_bytes += text.size();
  pass(name, stream, text, now);
}

void OutputCollector::begin_run(const std::string& id) {
  const auto found = streams_.find(id);
  if (found != streams_.end()) {
    found->second.run_bytes = 0;
  }
}

std::string_view OutputCollector::recent_of_run(const std::string& id) const {
  const auto found = streams_.find(id);
  if (found == streams_.end()) {
    return {};
  }
  const std::string_view recent = found->second.recent;
  return recent.substr(recent.size() - std::min(recent.size(), found->second.run_bytes));
}

void OutputCollector::pass(const std::string& name, Stream& stream, std::string_view text,
                           time::SteadyTime now) {
  if (stream.release) {
    hold(stream, text);
    return;
  }
  std::size_t passing = take_tokens(stream, text.size(), now);
  if (passing < text.size()) {
    // Up to the end of a line; for a longer line as much as may pass.
    const std::size_t line_end = text.substr(0, passing).rfind('\n');
    const std::size_t whole_lines = line_end == std::string_view::npos ? passing : line_end + 1;
    stream.bucket.give_back(passing - whole_lines);
    total_.give_back(passing - whole_lines);
    passing = whole_lines;
    stream.release = now + kHoldTime;
    hold(stream, text.substr(passing));
  }
  if (passing > 0) {
    stream.is_line_open = text[passing - 1] != '\n';
    append(name, text.substr(0, passing));
  }
}

std::size_t OutputCollector::take_tokens(Stream& stream, std::size_t wanted, time::SteadyTime now) {
  const std::size_t of_command = stream.bucket.take(wanted, now);
  const std::size_t passing = total_.take(of_command, now);
  stream.bucket.give_back(of_command - passing);
  return passing;
}

// Appends to a tail and keeps its newest lines. Returns the number of bytes dropped before them.
std::size_t OutputCollector::keep_newest(std::string& tail, std::string_view text) {
  tail += text;
  if (tail.size() <= kTailBytes) {
    return 0;
  }
  const std::size_t least = tail.size() - kTailBytes;
  const std::size_t line_end = tail.find('\n', least - 1);
  // If no complete line fits, keeps the end of the last one.
  const bool has_whole_line = line_end != std::string::npos && line_end + 1 < tail.size();
  const std::size_t dropped = has_whole_line ? line_end + 1 : least;
  tail.erase(0, dropped);
  return dropped;
}

// Keeps the newest lines of a held-back stream and counts the dropped bytes.
void OutputCollector::hold(Stream& stream, std::string_view text) {
  const std::size_t dropped = keep_newest(stream.tail, text);
  stream.dropped_bytes += static_cast<std::int64_t>(dropped);
  dropped_bytes_ += static_cast<std::int64_t>(dropped);
}

void OutputCollector::forget(const std::string& id) {
  const auto found = streams_.find(id);
  if (found != streams_.end() && found->second.release) {
    found->second.is_forgotten = true;
  } else if (found != streams_.end()) {
    streams_.erase(found);
  }
}

// Publishes the newest lines of a stream that was held back, or holds them back for longer if
// there is no room for them.
void OutputCollector::release(const std::string& id, Stream& stream, time::SteadyTime now) {
  const std::size_t passing = take_tokens(stream, stream.tail.size(), now);
  if (passing < stream.tail.size()) {
    stream.bucket.give_back(passing);
    total_.give_back(passing);
    stream.release = now + kHoldTime;
    return;
  }
  if (stream.dropped_bytes > 0) {
    append(id, (stream.is_line_open ? "\n[nodmap-deputy: " : "[nodmap-deputy: ") +
                   std::to_string(std::exchange(stream.dropped_bytes, 0)) +
                   " bytes of output dropped]\n");
  }
  stream.is_line_open = !stream.tail.ends_with('\n');
  append(id, std::exchange(stream.tail, {}));
  stream.release.reset();
}

void OutputCollector::append(const std::string& id, std::string_view text) {
  if (text.empty()) {
    return;
  }
  auto found = std::ranges::find(pending_, id, &CommandOutput::command_id);
  if (found == pending_.end()) {
    found = pending_.insert(pending_.end(), {id, {}});
  }
  found->text += text;
  pending_bytes_ += text.size();
}

std::vector<CommandOutput> OutputCollector::take(time::SteadyTime now) {
  for (auto& [id, stream] : streams_) {
    if (stream.release && now >= *stream.release) {
      release(id, stream, now);
    }
  }
  std::erase_if(streams_,
                [](const auto& item) { return item.second.is_forgotten && !item.second.release; });
  const bool is_prompt = pending_bytes_ > kPromptBytes && !is_rest_;
  if (pending_.empty() || (now - published_ < kPeriod && !is_prompt)) {
    return {};
  }
  published_ = now;
  std::vector<CommandOutput> message = take_front(kMaxMessageBytes);
  is_rest_ = !pending_.empty();
  return message;
}

// Takes up to `room` bytes of the pending output, short texts first, so that a flood does not
// delay the others.
std::vector<CommandOutput> OutputCollector::take_front(std::size_t room) {
  if (pending_bytes_ > room) {
    std::ranges::stable_sort(pending_, {},
                             [](const CommandOutput& part) { return part.text.size(); });
  }
  std::vector<CommandOutput> front;
  while (!pending_.empty() && room > 0) {
    CommandOutput& first = pending_.front();
    const std::size_t size = std::min(room, first.text.size());
    front.push_back({first.command_id, first.text.substr(0, size)});
    first.text.erase(0, size);
    room -= size;
    pending_bytes_ -= size;
    if (first.text.empty()) {
      pending_.erase(pending_.begin());
    }
  }
  return front;
}

void OutputCollector::repeat() {
  for (auto& [id, stream] : streams_) {
    if (!std::exchange(stream.is_to_repeat, true)) {
      to_repeat_.push_back(id);
    }
  }
}

// Whether nothing of a command's output is waiting to be published.
bool OutputCollector::is_published(const std::string& id) const {
  const auto found = streams_.find(id);
  const bool is_held = found != streams_.end() && found->second.release;
  return !is_held && std::ranges::find(pending_, id, &CommandOutput::command_id) == pending_.end();
}

std::vector<CommandOutput> OutputCollector::take_repeated(time::SteadyTime now) {
  constexpr std::size_t kMostCommands = kMaxMessageBytes / kTailBytes;
  std::vector<CommandOutput> message;
  if (now - repeated_ < kRepeatPeriod) {
    return message;
  }
  while (message.size() < kMostCommands) {
    const auto next = std::ranges::find_if(
        to_repeat_, [this](const std::string& id) { return is_published(id); });
    if (next == to_repeat_.end()) {
      break;
    }
    const auto found = streams_.find(*next);
    if (found != streams_.end()) {
      found->second.is_to_repeat = false;
      message.push_back({*next, found->second.recent});
      repeated_ = now;
    }
    to_repeat_.erase(next);
  }
  return message;
}

std::optional<time::SteadyTime> OutputCollector::repeat_due() const {
  const bool is_any_ready =
      std::ranges::any_of(to_repeat_, [this](const std::string& id) { return is_published(id); });
  return is_any_ready ? std::optional(repeated_ + kRepeatPeriod) : std::nullopt;
}

std::optional<time::SteadyTime> OutputCollector::due() const {
  std::optional<time::SteadyTime> due;
  if (!pending_.empty()) {
    due = published_ + kPeriod;
  }
  for (const auto& [id, stream] : streams_) {
    if (stream.release) {
      due = std::min(due.value_or(*stream.release), *stream.release);
    }
  }
  return due;
}

}  // namespace nodmap::procman
