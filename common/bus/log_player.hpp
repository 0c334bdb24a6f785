// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/event_log.hpp"
#include "common/geometry/time.hpp"

namespace nodmap::bus {

/// Plays event logs as a bus: several at once, merged by log time. Time is what the caller says
/// has passed; nothing is published.
class LogPlayer : public Bus {
 public:
  static constexpr double kMinSpeed = 0.01;
  static constexpr double kMaxSpeed = 100.0;

  /// Reads each log once, for its first and last time. Throws formats::InputFileError when one
  /// cannot be read or none holds an event.
  explicit LogPlayer(std::vector<std::filesystem::path> logs);

  /// Lets time pass at the present speed.
  void advance(time::Duration elapsed);

  /// Hands over events up to the present position, at most `max_events`. Whether all are handed
  /// over: after a seek much can be waiting.
  bool catch_up(std::int64_t max_events);

  void set_paused(bool paused) { paused_ = paused; }
  /// Clamped to [kMinSpeed, kMaxSpeed].
  void set_speed(double speed);
  /// Goes to this time after the log's begin, clamped to its length. True when that is back:
  /// everything is handed over anew, and who keeps state must forget it.
  [[nodiscard]] bool seek(time::Duration position);

  /// A sentence for each log that is damaged or cut off.
  [[nodiscard]] const std::vector<std::string>& damages() const { return damages_; }
  [[nodiscard]] bool paused() const { return paused_; }
  [[nodiscard]] double speed() const { return speed_; }
  [[nodiscard]] time::Duration position() const { return position_; }
  [[nodiscard]] time::Duration duration() const { return last_ - first_; }
  /// Log time at the present position.
  [[nodiscard]] time::Timestamp now() const { return first_ + position_; }
  /// Log time of the event being handed over; the epoch before the first.
  [[nodiscard]] time::Timestamp event_time() const { return event_time_; }
  [[nodiscard]] bool at_end() const { return position_ >= duration(); }

 private:
  struct Source {
    std::unique_ptr<LogReader> reader;
    const LogEvent* event = nullptr;  // the next one; null at the end
  };

  void rewind();
  [[nodiscard]] Source* earliest();
  void hand_over(const LogEvent& event);
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
  double speed_ = 1.0;
  bool paused_ = false;
};

}  // namespace nodmap::bus
