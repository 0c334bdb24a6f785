// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/drive_watchdog.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::kurt {
namespace {

/// Clocks of two machines under NTP differ by less.
constexpr std::int64_t kFutureToleranceUs = 50'000;
constexpr double kImplausibleSpeedMps = 2.0 * kTopSpeedMps;
/// Three turns a second.
constexpr double kImplausibleYawRateRadS = 6.0 * geometry::kPi;

}  // namespace

const char* name_of(DriveVerdict verdict) {
  switch (verdict) {
    case DriveVerdict::kObeyed:
      return "obeyed";
    case DriveVerdict::kNotFinite:
      return "drive_not_finite";
    case DriveVerdict::kImplausible:
      return "drive_implausible";
    case DriveVerdict::kStale:
      return "drive_stale";
    case DriveVerdict::kFromFuture:
      return "drive_from_future";
    case DriveVerdict::kOutOfOrder:
      break;
  }
  return "drive_out_of_order";
}

DriveVerdict DriveWatchdog::judge(const DriveRequest& request, std::int64_t utime_us,
                                  std::int64_t now_us) const {
  const DriveCommand& command = request.command;
  if (!std::isfinite(command.forward_mps) || !std::isfinite(command.yaw_rate_rad_s)) {
    return DriveVerdict::kNotFinite;
  }
  if (std::abs(command.forward_mps) > kImplausibleSpeedMps ||
      std::abs(command.yaw_rate_rad_s) > kImplausibleYawRateRadS || request.valid_us <= 0) {
    return DriveVerdict::kImplausible;
  }
  // Compared without a sum or difference that a wild number could overflow.
  if (request.utime_us > utime_us + kFutureToleranceUs) {
    return DriveVerdict::kFromFuture;
  }
  if (request.utime_us <= utime_us - std::min(timeout_us_, request.valid_us)) {
    return DriveVerdict::kStale;
  }
  if (obeyed_ && now_us < obeyed_->until_us && request.utime_us < obeyed_->utime_us) {
    return DriveVerdict::kOutOfOrder;
  }
  return DriveVerdict::kObeyed;
}

DriveVerdict DriveWatchdog::offer(const DriveRequest& request, std::int64_t utime_us,
                                  std::int64_t now_us) {
  const DriveVerdict verdict = judge(request, utime_us, now_us);
  if (verdict == DriveVerdict::kObeyed) {
    const std::int64_t age_us = std::max<std::int64_t>(0, utime_us - request.utime_us);
    obeyed_ = {request.command, request.utime_us,
               now_us + std::min(timeout_us_, request.valid_us) - age_us};
  } else if (verdict == DriveVerdict::kNotFinite || verdict == DriveVerdict::kImplausible) {
    revoke();
  }
  return verdict;
}

std::optional<DriveCommand> DriveWatchdog::command(std::int64_t now_us) const {
  if (!obeyed_ || now_us >= obeyed_->until_us) {
    return std::nullopt;
  }
  return obeyed_->command;
}

}  // namespace nodmap::kurt
