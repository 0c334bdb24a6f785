// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/time.hpp"
#include "procman/protocol/values.hpp"

namespace nodmap::procman {

/// Limits bytes to a rate, with an initial burst.
class TokenBucket {
 public:
  TokenBucket(double bytes_per_s, double burst_bytes)
      : bytes_per_s_(bytes_per_s), burst_bytes_(burst_bytes), tokens_(burst_bytes) {}

  /// Takes up to `wanted` bytes; returns how many may pass now.
  [[nodiscard]] std::size_t take(std::size_t wanted, time::SteadyTime now);
  /// Returns bytes that were taken but not used.
  void give_back(std::size_t bytes) { tokens_ += static_cast<double>(bytes); }

 private:
  double bytes_per_s_;
  double burst_bytes_;
  double tokens_;
  std::optional<time::SteadyTime> filled_;
};

/// Collects the output of commands into messages: one every 10 ms, or earlier when more than 4 KiB
/// are waiting, as the existing deputy does. In addition it limits the rate.
///
/// A command that writes more than its rate is held back for a second. Of that second only the
/// newest lines are published, after a note of how much was dropped. So the last line of a command
/// is never lost, and no line is cut.
class OutputCollector {
 public:
  static constexpr time::Duration kPeriod = 10ms;
  static constexpr std::size_t kPromptBytes = 4096;
  /// Fits into one LCM datagram (64 KiB). The rest of a burst follows in messages every 10 ms.
  static constexpr std::size_t kMaxMessageBytes = std::size_t{32} * 1024;
  // More than anyone can read, and little beside the 1.2 MB/s of the robot's channels.
  static constexpr double kCommandBytesPerS = 64.0 * 1024.0;
  static constexpr double kCommandBurstBytes = 128.0 * 1024.0;
  static constexpr double kTotalBytesPerS = 512.0 * 1024.0;
  static constexpr double kTotalBurstBytes = 1024.0 * 1024.0;
  static constexpr std::size_t kMaxStreams = 10'000;
  static constexpr time::Duration kHoldTime = 1s;
  /// Kept of the output of each command: about fifty lines.
  static constexpr std::size_t kTailBytes = 4096;
  /// Between two messages of repeated output. Limits it to 320 KiB/s, however many sheriffs ask.
  static constexpr time::Duration kRepeatPeriod = 100ms;

  /// Adds output of a command; an empty id means the deputy itself.
  void add(const std::string& id, std::string_view written, time::SteadyTime now);

  /// A new run of a command begins.
  void begin_run(const std::string& id);
  /// The newest lines of the present or last run of a command; empty if it has written nothing.
  [[nodiscard]] std::string_view recent_of_run(const std::string& id) const;

  /// The output to be published now, if any.
  [[nodiscard]] std::vector<CommandOutput> take(time::SteadyTime now);

  /// When take() will next have something.
  [[nodiscard]] std::optional<time::SteadyTime> due() const;

  /// The newest lines of all commands are wanted again, by a sheriff that was started later.
  void repeat();

  /// Of these the ones to be published now, if any, as a message of their own: all output of their
  /// commands up to the last take(). What take() returns later follows them without a gap.
  [[nodiscard]] std::vector<CommandOutput> take_repeated(time::SteadyTime now);

  /// When take_repeated() will next have something, unless it waits for take().
  [[nodiscard]] std::optional<time::SteadyTime> repeat_due() const;

  /// Bytes dropped so far, of all commands.
  [[nodiscard]] std::int64_t dropped_bytes() const { return dropped_bytes_; }

  /// Forgets a command that was removed. Its held-back output is still published.
  void forget(const std::string& id);

 private:
  /// The output of one command.
  struct Stream {
    TokenBucket bucket{kCommandBytesPerS, kCommandBurstBytes};
    std::optional<time::SteadyTime> release;  // held back until then
    std::string tail;                         // the newest lines since the start of holding back
    std::string recent;                       // the newest lines of all runs
    std::size_t run_bytes = 0;                // written by the present or last run
    std::int64_t dropped_bytes = 0;           // dropped before the tail, not yet reported
    bool is_line_open = false;                // the published output ends within a line
    bool is_forgotten = false;
    bool is_to_repeat = false;
  };

  /// How many of `wanted` bytes of a stream may pass now by its own limit and the common one.
  [[nodiscard]] std::size_t take_tokens(Stream& stream, std::size_t wanted, time::SteadyTime now);
  void pass(const std::string& name, Stream& stream, std::string_view text, time::SteadyTime now);
  static std::size_t keep_newest(std::string& tail, std::string_view text);
  void hold(Stream& stream, std::string_view text);
  void release(const std::string& id, Stream& stream, time::SteadyTime now);
  void append(const std::string& id, std::string_view text);
  [[nodiscard]] std::vector<CommandOutput> take_front(std::size_t room);
  [[nodiscard]] bool is_published(const std::string& id) const;

  std::map<std::string, Stream> streams_;
  TokenBucket total_{kTotalBytesPerS, kTotalBurstBytes};
  std::vector<CommandOutput> pending_;
  std::size_t pending_bytes_ = 0;
  bool is_rest_ = false;  // the pending output did not fit into the previous message
  std::int64_t dropped_bytes_ = 0;
  time::SteadyTime published_{};
  std::vector<std::string> to_repeat_;  // commands, in the order in which they were asked for
  time::SteadyTime repeated_{};
};

}  // namespace nodmap::procman
