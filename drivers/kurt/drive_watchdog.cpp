// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/drive_watchdog.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::kurt {
namespace {

/// DRIVE is stamped with the time of ODOMETRY, which is this driver's own clock: what is ahead of
/// it was stamped by somebody else. It may have been set back by a little meanwhile.
constexpr std::int64_t kFutureToleranceUs = 5'000;
constexpr double kImplausibleSpeedMps = 2.0 * kTopSpeedMps;
/// Three revolutions a second.
constexpr double kImplausibleYawRateRadS = 6.0 * geometry::kPi;

}  // namespace

const char* name_of(DriveStatus status) {
  switch (status) {
    case DriveStatus::kObeyed:
      return "obeyed";
    case DriveStatus::kNotFinite:
      return "drive_not_finite";
    case DriveStatus::kImplausible:
      return "drive_implausible";
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

DriveStatus DriveWatchdog::classify(const DriveRequest& request, std::int64_t utime_us,
                                    std::int64_t now_us) const {
  const DriveCommand& command = request.command;
  if (!std::isfinite(command.forward_mps) || !std::isfinite(command.yaw_rate_rad_s)) {
    return DriveStatus::kNotFinite;
  }
  if (std::abs(command.forward_mps) > kImplausibleSpeedMps ||
      std::abs(command.yaw_rate_rad_s) > kImplausibleYawRateRadS || request.valid_us <= 0) {
    return DriveStatus::kImplausible;
  }
  // Compared without a sum or difference that a wild number could overflow.
  if (request.utime_us > utime_us + kFutureToleranceUs) {
    return DriveStatus::kFromFuture;
  }
  if (request.utime_us <= utime_us - std::min(timeout_us_, request.valid_us)) {
    return DriveStatus::kStale;
  }
  if (obeyed_ && now_us < obeyed_->until_us && request.utime_us < obeyed_->utime_us) {
    return DriveStatus::kOutOfOrder;
  }
  return DriveStatus::kObeyed;
}

DriveStatus DriveWatchdog::offer(const DriveRequest& request, std::int64_t utime_us,
                                 std::int64_t now_us) {
  const bool is_followed = sender_.follow(request.seq, now_us);
  const DriveStatus status = classify(request, utime_us, now_us);
  const bool is_nonsense = status == DriveStatus::kNotFinite || status == DriveStatus::kImplausible;
  if (is_nonsense || sender_.is_contested(now_us)) {
    revoke();
  }
  if (is_nonsense) {
    return status;
  }
  if (!is_followed || sender_.is_contested(now_us)) {
    return DriveStatus::kOtherSender;
  }
  if (status == DriveStatus::kObeyed) {
    const std::int64_t age_us = std::max<std::int64_t>(0, utime_us - request.utime_us);
    // A stamp ahead of our clock must not make later commands look older.
    obeyed_ = {request.command, std::min(request.utime_us, utime_us),
               now_us + std::min(timeout_us_, request.valid_us) - age_us};
  }
  return status;
}

std::optional<DriveCommand> DriveWatchdog::command(std::int64_t now_us) const {
  if (!obeyed_ || now_us >= obeyed_->until_us) {
    return std::nullopt;
  }
  return obeyed_->command;
}

}  // namespace nodmap::kurt
