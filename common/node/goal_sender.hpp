// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <boost/circular_buffer.hpp>
#include <cstdint>
#include <optional>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "nodmap/goal_t.hpp"

namespace nodmap::node {

/// Publishes GOAL, and repeats it for a navigator that has missed it or was started later.
class GoalSender {
 public:
  explicit GoalSender(bus::Bus& bus) : bus_(bus) {}

  /// Publishes a new goal. Sets its time, number and `is_active`. Its time is above that of the one
  /// before, also after the clock was set back, because the navigator's reports name the goal by
  /// it.
  void set(nodmap::goal_t goal, time::Timestamp now);

  /// Publishes the present goal again once a second.
  void repeat_if_due(time::Timestamp now);

  /// Whether the navigator's report with this `goal_utime` is about the present goal.
  [[nodiscard]] bool is_about(std::int64_t goal_utime) const {
    return published_ && goal_utime == goal_.utime;
  }

  /// Whether this is one of the last goals that were set here; the bus delivers them to us as well.
  [[nodiscard]] bool is_own(const nodmap::goal_t& message) const;

  /// How many messages were published.
  [[nodiscard]] std::int64_t num_published() const { return goal_.goal_seq; }

 private:
  void publish(time::Timestamp now);

  bus::Bus& bus_;
  nodmap::goal_t goal_{};  // the present one, with the number of its next message
  std::optional<time::Timestamp> published_;
  boost::circular_buffer<nodmap::goal_t> own_{16};
};

}  // namespace nodmap::node
