// SPDX-License-Identifier: BSD-3-Clause
#include "common/bus/log_player.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace nodmap::bus {
namespace {

// A greater step of log time, from one event to the next, is a step of the clock. Processes
// publish STATUS every second, and events are logged nearly in the order in which they are
// received.
constexpr time::Duration kLongestPause = 60s;
constexpr time::Duration kLongestStepBack = 1s;

}  // namespace

LogPlayer::LogPlayer(std::vector<std::filesystem::path> logs) : logs_(std::move(logs)) {
  if (logs_.empty()) {
    throw std::runtime_error("no log to play");
  }
  rewind();
  while (Source* source = earliest()) {
    hand_over(*source);
    first_ = std::min(first_, event_time_);
    last_ = std::max(last_, event_time_);
  }
  for (const Source& source : sources_) {
    if (std::string damage = source.reader->damage(); !damage.empty()) {
      damages_.push_back(std::move(damage));
    }
  }
  if (first_ > last_) {
    LogReader(logs_.front()).require_event();
  }
  rewind();
}

void LogPlayer::rewind() {
  event_time_ = {};
  logged_.reset();
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
    if (source == nullptr || time_of(*source->event) > now()) {
      return true;
    }
    hand_over(*source);
  }
  return false;
}

time::Timestamp LogPlayer::time_of(const LogEvent& event) const {
  const time::Timestamp logged = time::from_utime(event.log_utime_us);
  if (!logged_) {
    return logged;
  }
  const time::Duration passed = logged - *logged_;
  const bool was_set = passed > kLongestPause || passed < -kLongestStepBack;
  return event_time_ + (was_set ? 0us : passed);
}

void LogPlayer::hand_over(Source& source) {
  const LogEvent& event = *source.event;
  event_time_ = time_of(event);
  logged_ = time::from_utime(event.log_utime_us);
  // The log's time, made continuous where the clock was set, is both clocks.
  set_origin({.sender = {},
              .received = event_time_,
              .arrived = time::SteadyTime(event_time_.time_since_epoch())});
  if (const auto found = handlers_.find(event.channel); found != handlers_.end()) {
    for (const BytesHandler& handler : found->second) {
      handler(event.data);
    }
  }
  source.event = source.reader->next();
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
