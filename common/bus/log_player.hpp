// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/event_log.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::bus {

/// A bus that plays one or more event logs, merged by log time. The caller says how much time
/// passes; published messages are discarded. A message counts as received at its time.
///
/// Its times are log times without the steps of the clock: where the clock was set while the logger
/// ran, time goes on without a pause, and so it does after a minute without events. Otherwise a
/// computer that boots with a wrong time would leave a hole of hours or years in its recording.
class LogPlayer : public Bus {
 public:
  static constexpr double kMinSpeed = 0.01;
  static constexpr double kMaxSpeed = 100.0;

  /// Reads all logs once, for the first and the last time. Throws formats::InputFileError when one
  /// cannot be read or none holds an event.
  explicit LogPlayer(std::vector<std::filesystem::path> logs);

  /// Advances by `elapsed` at the present speed, and delivers the events of this interval.
  void advance(time::Duration elapsed);

  /// Delivers events up to the present position, at most `max_events`. Returns whether all have
  /// been delivered: after a seek many may be waiting.
  bool catch_up(std::int64_t max_events);

  void set_paused(bool paused) { paused_ = paused; }
  /// Clamped to [kMinSpeed, kMaxSpeed].
  void set_speed(double speed);
  /// Moves to a time of the log, counted from its start, clamped to its length. Returns true if
  /// this is a step back: then all events are delivered again from the start, and subscribers must
  /// clear their state.
  [[nodiscard]] bool seek(time::Duration position);

  /// A message for each log that is damaged or truncated.
  [[nodiscard]] const std::vector<std::string>& damages() const { return damages_; }
  [[nodiscard]] bool paused() const { return paused_; }
  [[nodiscard]] double speed() const { return speed_; }
  [[nodiscard]] time::Duration position() const { return position_; }
  [[nodiscard]] time::Duration duration() const { return last_ - first_; }
  /// Time at the present position.
  [[nodiscard]] time::Timestamp now() const { return first_ + position_; }
  /// Time of the event being delivered; the epoch before the first.
  [[nodiscard]] time::Timestamp event_time() const { return event_time_; }
  /// The log time of this event as it stands in its file, where it may step.
  [[nodiscard]] time::Timestamp logged_time() const { return logged_.value_or(time::Timestamp{}); }
  [[nodiscard]] bool at_end() const { return position_ >= duration(); }

 private:
  struct Source {
    std::unique_ptr<LogReader> reader;
    const LogEvent* event = nullptr;  // the next one; null at the end
  };

  void rewind();
  [[nodiscard]] Source* earliest();
  /// The time of the next event.
  [[nodiscard]] time::Timestamp time_of(const LogEvent& event) const;
  /// Delivers the source's event and reads its next one.
  void hand_over(Source& source);
  bool send(const std::string& channel, std::span<const std::byte> bytes) override;
  void listen(const std::string& channel, BytesHandler handler, int queue_capacity) override;

  std::vector<std::filesystem::path> logs_;
  std::vector<Source> sources_;
  std::vector<std::string> damages_;
  std::map<std::string, std::vector<BytesHandler>, std::less<>> handlers_;
  time::Timestamp first_ = time::Timestamp::max();
  time::Timestamp last_ = time::Timestamp::min();
  time::Duration position_{};
  time::Timestamp event_time_{};
  std::optional<time::Timestamp> logged_;  // the log time of that event
  double speed_ = 1.0;
  bool paused_ = false;
};

}  // namespace nodmap::bus
