// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/time.hpp"
#include "common/node/sender_watch.hpp"
#include "drivers/kurt/speed_limiter.hpp"

namespace nodmap::kurt {

/// A command as it came in.
struct DriveRequest {
  DriveCommand command;
  time::Timestamp stamp;      ///< when it was decided
  time::Duration validity{};  ///< for how long from then
  std::int64_t seq = 0;       ///< the sender's count
};

/// What became of a DRIVE.
enum class DriveStatus : std::uint8_t {
  kObeyed,
  kNotFinite,    ///< NaN or infinite
  kImplausible,  ///< faster than the robot could ever go, or valid for no time
  kStale,        ///< too old
  kFromFuture,   ///< newer than now: the clocks of sender and driver differ
  kOutOfOrder,   ///< older than the one that is being obeyed
  kOtherSender,  ///< not of the sender that is followed, or two senders are alive
};

/// The name under which such a DRIVE is counted.
[[nodiscard]] const char* name_of(DriveStatus status);

/// Decides whether the robot may move.
///
/// Why the robot stops after 200 ms without a DRIVE: the navigator sends one with every scan, 75 a
/// second. When 15 in a row are missing, something is wrong with the navigator, its machine or the
/// network. In 200 ms the robot covers 0.3 m at the 1.5 m/s of the paper's runs, and then brakes.
/// The navigator keeps that distance free anyway, because the laser needs a fraction of a second
/// for each sweep to see what is ahead. With a longer time-out the robot would drive on although
/// nobody watches what is ahead; with a shorter one it would stutter whenever the scheduler is
/// late. The base has a time-out of its own behind this one: it stops when it hears nothing from
/// the driver for 100 ms, so killing the driver stops the robot, too.
///
/// One sender is followed (SenderWatch). While two are alive the robot is stationary: which of them
/// means well cannot be known.
class DriveWatchdog {
 public:
  explicit DriveWatchdog(time::Duration timeout) : timeout_(timeout) {}

  /// A DRIVE has come. `wall` and `now` are now on both clocks.
  /// Nonsense revokes what was obeyed before: who sends nonsense is not to be trusted.
  DriveStatus offer(const DriveRequest& request, time::Timestamp wall, time::SteadyTime now);

  /// The command to obey; empty: stop.
  [[nodiscard]] std::optional<DriveCommand> command(time::SteadyTime now) const;

  /// Whether two processes send DRIVE, so that none of them is obeyed.
  [[nodiscard]] bool is_contested(time::SteadyTime now) const { return sender_.is_contested(now); }

  /// Stops until the next command: the link to the base was lost, say.
  void revoke() { obeyed_.reset(); }

 private:
  struct Obeyed {
    DriveCommand command;
    time::Timestamp stamp;
    time::SteadyTime until;
  };

  [[nodiscard]] DriveStatus classify(const DriveRequest& request, time::Timestamp wall,
                                     time::SteadyTime now) const;

  time::Duration timeout_;
  node::SenderWatch sender_;
  std::optional<Obeyed> obeyed_;
};

}  // namespace nodmap::kurt
