// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "common/geometry/time.hpp"
#include "modules/navigator/params.hpp"
#include "modules/navigator/reason.hpp"

namespace nodmap::navigator {

/// The stamp of the newest message of each input; empty: none yet.
struct InputStamps {
  std::optional<time::Timestamp> odometry;
  std::optional<time::Timestamp> map;
  std::optional<time::Timestamp> scan;  ///< the middle of the last scan in the local map
  std::optional<time::Timestamp> pitch_command;
  std::optional<time::Timestamp> pitch_state;
};

/// A BASE_SENSORS older than this, by odometry, is not used: somebody may have stepped since to
/// where it shows nobody. Without any the robot drives: not every base has range finders. Four
/// messages.
inline constexpr time::Duration kMaxBaseSensorsAge = 200ms;

/// Why the robot must halt with inputs of these stamps; empty if it need not.
///
/// Odometry is the clock: 100 messages a second from the driver that also stops the wheels. An
/// input much newer than odometry means that odometry is stale or a stamp is wrong, so the robot
/// halts then, too. Only the newest message of each input counts: one wrong stamp halts the robot
/// only until the next message.
///
/// Why the limits are safe: the loss of an input is noticed within its limit and one odometry
/// period (10 ms) after its last message. With the longest limit, 150 ms, the robot drives 0.24 m
/// at 1.5 m/s before it brakes; the whole robot is allowed 0.3 m and 300 ms. Each limit is several
/// periods of its input, so that a late message does not stop the robot:
///   map and scan 100 ms: seven scans. The stamps are the middle of the scan, normally 13 to 25 ms
///     old. Without scans the local map knows no new hole and no new obstacle.
///   odometry 100 ms: ten messages. Without any input no DRIVE is published, and the driver stops
///     the wheels when the last one is no longer valid (150 ms).
///   speed bound of the pitch controller 120 ms: six messages.
///   pitch servo 150 ms: 30 readings.
/// `needs_scans`: whether the robot also drives by the local map.
[[nodiscard]] std::optional<Reason> reason_by_staleness(const InputStamps& stamps,
                                                        const StalenessParams& limits,
                                                        bool needs_scans);

}  // namespace nodmap::navigator
