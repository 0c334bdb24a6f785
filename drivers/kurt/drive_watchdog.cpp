// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/drive_watchdog.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::kurt {
namespace {

// DRIVE is stamped with the time of ODOMETRY, which is this driver's own clock, so a stamp in the
// future is from another sender. The tolerance is for a wall clock that was set back slightly.
constexpr time::Duration kFutureTolerance = 5ms;
constexpr double kImplausibleSpeedMps = 2.0 * kTopSpeedMps;
// Three revolutions per second.
constexpr double kImplausibleYawRateRadS = 6.0 * geometry::kPi;

}  // namespace

const char* name_of(DriveStatus status) {
  switch (status) {
    case DriveStatus::kObeyed:
      return "obeyed";
    case DriveStatus::kNotFinite:
      return "drive_not_finite";
    case DriveStatus::kImplausible:
      return "implausible_drive";
    case DriveStatus::kStale:
      return "drive_stale";
    case DriveStatus::kFromFuture:
      return "drive_from_future";
    case DriveStatus::kOutOfOrder:
      return "drive_out_of_order";
    case DriveStatus::kOtherSender:
      break;
  }
  return "drive_other_sender";
}

DriveStatus DriveWatchdog::classify(const DriveRequest& request, time::Timestamp wall,
                                    time::SteadyTime now) const {
  const DriveCommand& command = request.command;
  if (!std::isfinite(command.forward_mps) || !std::isfinite(command.yaw_rate_rad_s)) {
    return DriveStatus::kNotFinite;
  }
  if (std::abs(command.forward_mps) > kImplausibleSpeedMps ||
      std::abs(command.yaw_rate_rad_s) > kImplausibleYawRateRadS || request.validity <= 0us) {
    return DriveStatus::kImplausible;
  }
  if (request.stamp > wall + kFutureTolerance) {
    return DriveStatus::kFromFuture;
  }
  if (request.stamp <= wall - std::min(timeout_, request.validity)) {
    return DriveStatus::kStale;
  }
  if (obeyed_ && now < obeyed_->until && request.stamp < obeyed_->stamp) {
    return DriveStatus::kOutOfOrder;
  }
  return DriveStatus::kObeyed;
}

DriveStatus DriveWatchdog::offer(const DriveRequest& request, time::Timestamp wall,
                                 time::SteadyTime now) {
  const time::SteadyTime arrived = now - request.waited;
  DriveStatus status = classify(request, wall - request.waited, arrived);
  bool is_followed = true;
  if (status == DriveStatus::kObeyed) {
    is_followed = sender_.follow(request.sender, arrived);
    status = classify(request, wall, now);
  } else {
    sender_.refuse(request.sender, arrived);
  }
  const bool is_nonsense = status == DriveStatus::kNotFinite || status == DriveStatus::kImplausible;
  if (is_nonsense || sender_.is_contested(now)) {
    revoke();
  }
  if (is_nonsense) {
    return status;
  }
  if (!is_followed || sender_.is_contested(now)) {
    return DriveStatus::kOtherSender;
  }
  if (status == DriveStatus::kObeyed) {
    const time::Duration age = std::max(wall - request.stamp, time::Duration{});
    // A stamp ahead of our clock must not make later commands look out of order.
    obeyed_ = {request.command, std::min(request.stamp, wall),
               now + std::min(timeout_, request.validity) - age};
  }
  return status;
}

std::optional<DriveCommand> DriveWatchdog::command(time::SteadyTime now) const {
  if (!obeyed_ || now >= obeyed_->until) {
    return std::nullopt;
  }
  return obeyed_->command;
}

}  // namespace nodmap::kurt
