// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/kurt/speed_limiter.hpp"

namespace nodmap::kurt {

/// A command as it came in.
struct DriveRequest {
  DriveCommand command;
  std::int64_t utime_us = 0;  ///< when it was decided
  std::int64_t valid_us = 0;  ///< for how long from then
};

enum class DriveVerdict : std::uint8_t {
  kObeyed,
  kNotFinite,    ///< NaN or infinite
  kImplausible,  ///< faster than the robot could ever go, or valid for no time
  kStale,        ///< too old
  kFromFuture,   ///< newer than now: the clocks of sender and driver differ
  kOutOfOrder,   ///< older than the one that is being obeyed
};

/// The name by which a verdict is counted.
[[nodiscard]] const char* name_of(DriveVerdict verdict);

/// Decides whether the robot may move.
///
/// The navigator sends DRIVE with every scan, 75 a second: 200 ms without one are 15 missed in a
/// row, and something is wrong with it, its machine or the network. At the 1.5 m/s of the paper's
/// runs the robot goes 0.3 m in this time, and then brakes. So much the navigator keeps free
/// anyway, for the laser, too, needs a fraction of a second per sweep to see what is ahead. A
/// longer time-out would drive blindly into what nobody watches for; a shorter one would stutter
/// with every hiccup of the scheduler. Behind this one stands the base's own: it stops when it
/// hears nothing from us for 100 ms, so that a driver that is killed stops the robot, too.
class DriveWatchdog {
 public:
  explicit DriveWatchdog(std::int64_t timeout_us) : timeout_us_(timeout_us) {}

  /// A DRIVE has come. `utime_us` is the wall clock now, `now_us` a monotonic one.
  /// Nonsense revokes what was obeyed before: a sender that sends nonsense is not to be trusted.
  DriveVerdict offer(const DriveRequest& request, std::int64_t utime_us, std::int64_t now_us);

  /// The command to obey; empty: stop.
  [[nodiscard]] std::optional<DriveCommand> command(std::int64_t now_us) const;

  /// Stops until the next command: the link to the base was lost, say.
  void revoke() { obeyed_.reset(); }

 private:
  struct Obeyed {
    DriveCommand command;
    std::int64_t utime_us = 0;
    std::int64_t until_us = 0;
  };

  [[nodiscard]] DriveVerdict judge(const DriveRequest& request, std::int64_t utime_us,
                                   std::int64_t now_us) const;

  std::int64_t timeout_us_;
  std::optional<Obeyed> obeyed_;
};

}  // namespace nodmap::kurt
