// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/time.hpp"
#include "procman/protocol/values.hpp"

namespace nodmap::procman {

/// Bytes that flow at a rate, after a burst at first.
class TokenBucket {
 public:
  TokenBucket(double bytes_per_s, double burst_bytes)
      : bytes_per_s_(bytes_per_s), burst_bytes_(burst_bytes), tokens_(burst_bytes) {}

  /// How many of `wanted` may pass now.
  [[nodiscard]] std::size_t take(std::size_t wanted, time::SteadyTime now);
  /// Gives back what was taken and not used.
  void give_back(std::size_t bytes) { tokens_ += static_cast<double>(bytes); }

 private:
  double bytes_per_s_;
  double burst_bytes_;
  double tokens_;
  std::optional<time::SteadyTime> filled_;
};

/// Gathers what commands write into messages: one at most each 10 ms unless more than 4 KiB wait,
/// as the existing deputy does; and, as it does not, no more than the bus should carry.
///
/// A command that writes more than its rate is held back for a second. Of what it writes in that
/// second only the newest lines are kept; the rest is dropped, and its output says how much. So
/// every line arrives whole, and the last line of a command always does.
class OutputCollector {
 public:
  static constexpr time::Duration kPeriod = 10ms;
  static constexpr std::size_t kPromptBytes = 4096;
  /// A message stays below LCM's 64 KiB for one datagram; the rest of a burst follows it each 10
  /// ms.
  static constexpr std::size_t kMaxMessageBytes = std::size_t{32} * 1024;
  // Far more than anyone can read, far less than would hurt: all the robot's channels take 1.2
  // MB/s.
  static constexpr double kCommandBytesPerS = 64.0 * 1024.0;
  static constexpr double kCommandBurstBytes = 128.0 * 1024.0;
  static constexpr double kTotalBytesPerS = 512.0 * 1024.0;
  static constexpr double kTotalBurstBytes = 1024.0 * 1024.0;
  static constexpr std::size_t kMaxStreams = 10'000;
  static constexpr time::Duration kHoldTime = 1s;
  /// Of a command that is held back, or has ended; some fifty lines.
  static constexpr std::size_t kTailBytes = 4096;

  /// What a command wrote; with the empty id what the deputy says.
  void add(const std::string& id, std::string_view text, time::SteadyTime now);

  /// Publishes the newest lines of a command once more, for who was not there to hear them.
  void repeat(const std::string& id, time::SteadyTime now);
  /// Those lines; empty where nothing was written.
  [[nodiscard]] std::string_view recent(const std::string& id) const;

  /// What is to be published now, if anything.
  [[nodiscard]] std::vector<CommandOutput> take(time::SteadyTime now);

  /// When take() will next have something.
  [[nodiscard]] std::optional<time::SteadyTime> due() const;

  /// Bytes dropped so far, of all commands.
  [[nodiscard]] std::int64_t dropped_bytes() const { return dropped_bytes_; }

  /// For a command that is not wanted any more. What is held back of it is still published.
  void forget(const std::string& id);

 private:
  /// What one command writes.
  struct Stream {
    TokenBucket bucket{kCommandBytesPerS, kCommandBurstBytes};
    std::optional<time::SteadyTime> release;  // it is held back until then
    std::string tail;                         // the newest lines since it is held back
    std::string recent;                       // the newest lines of all
    std::int64_t dropped_bytes = 0;           // before the tail, and not yet reported
    bool is_line_open = false;                // what has passed ends within a line
    bool is_forgotten = false;
  };

  /// How many of `wanted` bytes of a stream may pass now, by its own limit and the common one.
  [[nodiscard]] std::size_t take_tokens(Stream& stream, std::size_t wanted, time::SteadyTime now);
  void pass(const std::string& name, Stream& stream, std::string_view text, time::SteadyTime now);
  static std::size_t keep_newest(std::string& tail, std::string_view text);
  void hold(Stream& stream, std::string_view text);
  void release(time::SteadyTime now);
  void append(const std::string& id, std::string_view text);
  [[nodiscard]] std::vector<CommandOutput> take_front(std::size_t room);

  std::map<std::string, Stream> streams_;
  TokenBucket total_{kTotalBytesPerS, kTotalBurstBytes};
  std::vector<CommandOutput> pending_;
  std::size_t pending_bytes_ = 0;
  bool is_rest_ = false;  // what is pending did not fit into the message before
  std::int64_t dropped_bytes_ = 0;
  time::SteadyTime published_{};
};

}  // namespace nodmap::procman
