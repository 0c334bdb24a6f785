// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/log_player.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace nodmap::bus {

LogPlayer::LogPlayer(std::vector<std::filesystem::path> logs) : logs_(std::move(logs)) {
  first_utime_us_ = std::numeric_limits<std::int64_t>::max();
  last_utime_us_ = std::numeric_limits<std::int64_t>::min();
  for (const std::filesystem::path& log : logs_) {
    LogReader reader(log);
    while (const LogEvent* event = reader.next()) {
      first_utime_us_ = std::min(first_utime_us_, event->log_utime_us);
      last_utime_us_ = std::max(last_utime_us_, event->log_utime_us);
    }
    if (std::string damage = reader.damage(); !damage.empty()) {
      damages_.push_back(std::move(damage));
    }
  }
  if (logs_.empty()) {
    throw std::runtime_error("no log to play");
  }
  if (first_utime_us_ > last_utime_us_) {
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

void LogPlayer::advance(std::int64_t elapsed_us) {
  if (!paused_) {
    position_us_ += std::llround(speed_ * static_cast<double>(elapsed_us));
    position_us_ = std::min(position_us_, duration_us());
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
    if (source == nullptr || source->event->log_utime_us > utime_us()) {
      return true;
    }
    hand_over(*source->event);
    source->event = source->reader->next();
  }
  return false;
}

void LogPlayer::hand_over(const LogEvent& event) {
  event_utime_us_ = event.log_utime_us;
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

bool LogPlayer::seek(std::int64_t position_us) {
  const std::int64_t target_us = std::clamp<std::int64_t>(position_us, 0, duration_us());
  const bool back = target_us < position_us_;
  position_us_ = target_us;
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
