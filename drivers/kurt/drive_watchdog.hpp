// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/bus/sender.hpp"
#include "common/bus/sender_watch.hpp"
#include "common/geometry/time.hpp"
#include "drivers/kurt/speed_limiter.hpp"

namespace nodmap::kurt {

/// A command as received.
struct DriveRequest {
  DriveCommand command;
  time::Timestamp stamp;      ///< when it was decided
  time::Duration validity{};  ///< how long it is valid from then on
  bus::Sender sender{};
  time::Duration waited{};  ///< between its arrival and now, if the process could not read it
};

/// Whether a DRIVE is obeyed; if not, why.
enum class DriveStatus : std::uint8_t {
  kObeyed,
  kNotFinite,    ///< NaN or infinite
  kImplausible,  ///< faster than the robot can be, or without validity
  kStale,        ///< too old
  kFromFuture,   ///< stamped in the future: the clocks of sender and driver differ
  kOutOfOrder,   ///< older than the command being obeyed
  kOtherSender,  ///< not of the accepted sender, or there are two senders
};

/// The name under which a refused DRIVE is counted.
[[nodiscard]] const char* name_of(DriveStatus status);

/// Decides which DRIVE command the robot obeys, and stops it when none is valid.
///
/// Why the robot stops after 200 ms without a DRIVE: the navigator sends 75 per second, one for
/// each scan. When 15 in a row are missing, something is wrong with the navigator, its machine or
/// the network. In 200 ms the robot covers 0.3 m at the 1.5 m/s of the paper's runs, and then
/// brakes. The navigator keeps that distance free anyway, because the laser needs a fraction of a
/// second for each sweep. With a longer timeout the robot would drive on although no process
/// watches what is ahead; with a shorter one it would stutter whenever the scheduler is late. The
/// base has a timeout of its own: it stops when it has received nothing from the driver for 100 ms,
/// so killing the driver also stops the robot.
///
/// Only one sender is accepted (SenderWatch). While there are two, the robot is stationary, because
/// it is unknown which of them is legitimate. A driver that was frozen finds commands that were in
/// time when they arrived: they are not obeyed any more, but show that their sender is alive.
class DriveWatchdog {
 public:
  explicit DriveWatchdog(time::Duration timeout) : timeout_(timeout) {}

  /// Offers a DRIVE that has been received; `wall` and `now` are the present time on both clocks. A
  /// nonsensical one also revokes the command obeyed before, because its sender cannot be trusted.
  DriveStatus offer(const DriveRequest& request, time::Timestamp wall, time::SteadyTime now);

  /// The command to obey now; empty: stop.
  [[nodiscard]] std::optional<DriveCommand> command(time::SteadyTime now) const;

  /// Whether two processes send DRIVE, so that neither is obeyed.
  [[nodiscard]] bool is_contested(time::SteadyTime now) const { return sender_.is_contested(now); }

  /// Replaces the command obeyed now by zero speed, until the next one.
  void brake() {
    if (obeyed_) {
      obeyed_->command = {};
    }
  }

  /// Stops until the next command, for example because the link to the base was lost.
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
  bus::SenderWatch sender_;
  std::optional<Obeyed> obeyed_;
};

}  // namespace nodmap::kurt
