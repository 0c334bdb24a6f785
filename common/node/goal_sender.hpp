// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <boost/circular_buffer.hpp>
#include <cstdint>
#include <optional>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/navigation_t.hpp"

namespace nodmap::node {

/// A goal or a region with a greater coordinate, in metres, is refused as a mistake.
inline constexpr double kMaxCoordinateM = 1e4;

/// A goal with a greater tolerance, in metres, is refused as a mistake.
inline constexpr double kMaxGoalToleranceM = 10.0;

/// Home, x and y in map: the map's origin, where odometry began when 2D SLAM began the map. A map
/// that is continued, or in which the robot is localised, keeps its origin.
inline constexpr std::array<double, 2> kHomeM = {0.0, 0.0};

/// Publishes GOAL, or its cancellation, repeats it for a navigator that has missed it or was
/// started later, and knows from GOAL and NAVIGATION what has become of it.
class GoalSender {
 public:
  enum class Status : std::uint8_t {
    kNone,       ///< nothing was set yet
    kSent,       ///< no navigator has reported on it; also if the one that had it was restarted
    kTaken,      ///< the navigator drives to it, or has arrived; cancelled: it has no goal
    kLeft,       ///< the navigator had taken it and reports on another, whose GOAL was missed
    kOverruled,  ///< another sender has set or cancelled a goal
  };

  explicit GoalSender(bus::Bus& bus) : bus_(bus) {}

  /// Publishes a new goal. Sets its time, number and `is_active`. Its time is above that of the one
  /// before, also after the clock was set back, because the navigator's reports name the goal by
  /// it.
  void set(nodmap::goal_t goal, time::Timestamp now);

  /// Cancels the goal, whoever has set it.
  void cancel(time::Timestamp now);

  /// Publishes the present goal, or its cancellation, again once a second, unless another sender
  /// has overruled it.
  void repeat_if_due(time::Timestamp now);

  /// Takes a GOAL; returns whether it is another sender's. The bus delivers our own as well.
  bool take(const nodmap::goal_t& message);

  /// Takes a report of the navigator; returns whether it is about the present goal.
  bool take(const nodmap::navigation_t& message);

  [[nodiscard]] Status status() const { return status_; }

  /// Whether a report of the navigator with this `goal_utime` is about the present goal, or says
  /// that there is none after its cancellation.
  [[nodiscard]] bool is_about(std::int64_t goal_utime) const {
    return published_ && goal_utime == (goal_.is_active != 0 ? goal_.utime : 0);
  }

  /// How many messages were published.
  [[nodiscard]] std::int64_t num_published() const { return goal_.goal_seq; }

 private:
  void decide(nodmap::goal_t goal, bool is_active, time::Timestamp now);
  void publish(time::Timestamp now);
  // Whether this is one of the last goals that were set here.
  [[nodiscard]] bool is_own(const nodmap::goal_t& message) const;

  bus::Bus& bus_;
  Status status_ = Status::kNone;
  nodmap::goal_t goal_{};  // the present one, with the number of its next message
  std::optional<time::Timestamp> published_;
  std::optional<time::Timestamp> reported_;  // stamp of the navigator's last report, on any goal
  boost::circular_buffer<nodmap::goal_t> own_{16};
};

}  // namespace nodmap::node
