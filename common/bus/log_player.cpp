// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/log_player.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace nodmap::bus {

LogPlayer::LogPlayer(std::vector<std::filesystem::path> logs) : logs_(std::move(logs)) {
  for (const std::filesystem::path& log : logs_) {
    LogReader reader(log);
    while (const LogEvent* event = reader.next()) {
      first_ = std::min(first_, time::from_utime(event->log_utime_us));
      last_ = std::max(last_, time::from_utime(event->log_utime_us));
    }
    if (std::string damage = reader.damage(); !damage.empty()) {
      damages_.push_back(std::move(damage));
    }
  }
  if (logs_.empty()) {
    throw std::runtime_error("no log to play");
  }
  if (first_ > last_) {
    LogReader(logs_.front()).require_event();
  }
  rewind();
}

void LogPlayer::rewind() {
  sources_.clear();
  for (const std::filesystem::path& log : logs_) {
    Source source{std::make_unique<LogReader>(log), nullptr};
    source.event = source.reader->next();
    sources_.push_back(std::move(source));
  }
}

void LogPlayer::advance(time::Duration elapsed) {
  if (!paused_) {
    position_ += time::rounded(speed_ * time::FineDuration(elapsed));
    position_ = std::min(position_, duration());
  }
}

LogPlayer::Source* LogPlayer::earliest() {
  Source* first = nullptr;
  for (Source& source : sources_) {
    if (source.event != nullptr &&
        (first == nullptr || source.event->log_utime_us < first->event->log_utime_us)) {
      first = &source;
    }
  }
  return first;
}

bool LogPlayer::catch_up(std::int64_t max_events) {
  for (std::int64_t i = 0; i < max_events; ++i) {
    Source* source = earliest();
    if (source == nullptr || time::from_utime(source->event->log_utime_us) > now()) {
      return true;
    }
    hand_over(*source->event);
    source->event = source->reader->next();
  }
  return false;
}

void LogPlayer::hand_over(const LogEvent& event) {
  event_time_ = time::from_utime(event.log_utime_us);
  const auto found = handlers_.find(event.channel);
  if (found == handlers_.end()) {
    return;
  }
  for (const BytesHandler& handler : found->second) {
    handler(event.data);
  }
}

void LogPlayer::set_speed(double speed) {
  speed_ = std::clamp(speed, kMinSpeed, kMaxSpeed);
}

bool LogPlayer::seek(time::Duration position) {
  const time::Duration target = std::clamp<time::Duration>(position, 0s, duration());
  const bool back = target < position_;
  position_ = target;
  if (back) {
    rewind();
  }
  return back;
}

bool LogPlayer::send(const std::string& /*channel*/, std::span<const std::byte> /*bytes*/) {
  return false;
}

void LogPlayer::listen(const std::string& channel, BytesHandler handler, int /*queue_capacity*/) {
  handlers_[channel].push_back(std::move(handler));
}

}  // namespace nodmap::bus
