// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/circular_buffer.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "nodmap/stop_t.hpp"

namespace nodmap::node {

/// The requester that the base driver names while it is stopped by `by`.
[[nodiscard]] std::string confirmed_name(const std::string& by);

/// Whether the base driver says by this message that it is stopped.
[[nodiscard]] bool is_confirmation(const nodmap::stop_t& message);

/// Remembers who stopped the robot, by the messages on STOP.
///
/// Both messages come several times: a release because one may be lost; a STOP because a viewer,
/// with the time of the decision, and the base driver repeat it until a release has reached them.
///
/// | state          | STOP     | repetition of a STOP | release | copy of a release |
/// |----------------|----------|----------------------|---------|-------------------|
/// | free           | stopped  | only repeated        | free    | free              |
/// | stopped        | stopped* | stopped              | free    | stopped           |
/// | only repeated  | stopped* | only repeated*       | free    | free              |
///
/// * by whoever sent this one.
///
/// A copy does not lift a STOP, which is newer than the first release. It does lift what is only
/// repeated: the first release may have crossed the repetition, or may have been lost on its way to
/// whoever repeats. The base driver takes every repetition but its own for a STOP, so no copy
/// lifts anything there: if it is stopped, it says so to the others.
///
/// Decisions are told apart by their time and requester, never ordered by their time: hosts have
/// different clocks.
class StopLatch {
 public:
  enum class Change : std::uint8_t { kNone, kStopped, kReleased };

  /// For a process that is free to drive after its start.
  StopLatch() = default;
  /// For the base driver, which is stopped after its start. It recognises what it has repeated
  /// itself, and takes every other repetition for a STOP.
  explicit StopLatch(std::string stopped_by)
      : is_base_driver_(true), stopped_by_(std::move(stopped_by)) {}

  Change take(const nodmap::stop_t& message);

  /// Whether a message is a release that take() has not taken yet, and not a copy of one. Only such
  /// a release may allow anything besides driving: a copy may come after what a person has not
  /// seen.
  [[nodiscard]] bool is_new_release(const nodmap::stop_t& message) const;

  /// Stops the robot as a STOP does.
  Change stop(std::string by);

  [[nodiscard]] bool is_stopped() const { return stopped_by_.has_value(); }
  /// Empty: nobody.
  [[nodiscard]] const std::optional<std::string>& stopped_by() const { return stopped_by_; }

 private:
  /// What tells a decision from others, and is the same in the copies of its message.
  struct Decision {
    std::int64_t utime;
    std::string by;

    bool operator==(const Decision&) const = default;
  };

  [[nodiscard]] static std::string named_in(std::string by);
  [[nodiscard]] static Decision decision_of(const nodmap::stop_t& message);
  [[nodiscard]] Change release(const Decision& decision);

  bool is_base_driver_ = false;
  std::optional<std::string> stopped_by_;
  bool is_only_repeated_ = false;      // stopped by nothing but a repetition
  std::optional<Decision> last_stop_;  // that was no repetition
  /// The last ones. Copies arrive within a second, and nobody releases the robot this often in that
  /// time.
  boost::circular_buffer<Decision> releases_{16};
};

}  // namespace nodmap::node
