// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/sensor_input.hpp"

#include <chrono>
#include <cmath>

#include "common/geometry/time.hpp"
#include "common/node/messages.hpp"

namespace nodmap::node {
namespace {

// Far above the duration of any laser's mirror revolution.
constexpr time::Duration kLongestScan = 60s;
// Far above the period of any odometry. Smaller errors of a stamp harm no more than the one
// message.
constexpr time::Duration kLongestGap = 10s;

// Beyond what any of our bases can do: 5.2 m/s, and a body that spins eight times a second.
constexpr double kFastestMps = 20.0;
constexpr double kFastestRadS = 50.0;

// False for speeds that are not finite, too.
bool has_plausible_speeds(const nodmap::odometry_t& message) {
  return std::abs(message.forward_mps) <= kFastestMps &&
         std::abs(message.yaw_rate_rad_s) <= kFastestRadS;
}

// Whether two successive messages of one driver can have these stamps, if no clock was set.
bool is_near(time::Timestamp stamp, time::Timestamp other) {
  return std::chrono::abs(stamp - other) <= kLongestGap;
}

}  // namespace

bool SensorInput::read(const nodmap::scan_t& message, scan::Scan& scan) {
  if (!follows(scan_sender_, "other_sender_of_scan")) {
    return false;
  }
  counts_.lose(scans_.lost_before(message.scan_seq));
  if (!read_scan(message, scan) || !time::is_plausible(scan.stamp) ||
      scan.duration > kLongestScan) {
    counts_.reject("implausible_scan");
    return false;
  }
  if (scan.ranges_m.empty()) {
    counts_.reject("empty_scan");
    return false;
  }
  return true;
}

std::optional<geometry::SE3> SensorInput::read(const nodmap::odometry_t& message) {
  if (!follows(odometry_sender_, "other_sender_of_odometry")) {
    return std::nullopt;
  }
  counts_.lose(odometry_.lost_before(message.odometry_seq));
  auto T_odom_base = read_odometry(message);
  const Odometry odometry{message.odometry_seq, time::from_utime(message.utime)};
  if (!T_odom_base || !time::is_plausible(odometry.stamp) || !has_plausible_speeds(message)) {
    counts_.reject("implausible_odometry");
    return std::nullopt;
  }
  if (!accept(odometry)) {
    counts_.reject("unconfirmed_odometry");
    return std::nullopt;
  }
  return T_odom_base;
}

// Whether the message being handled is from the followed sender of its channel.
bool SensorInput::follows(bus::FollowedSender& sender, const char* cause) {
  const bus::Origin origin = bus_ != nullptr ? bus_->origin() : bus::Origin{};
  if (sender.follow(origin.sender, origin.arrived)) {
    return true;
  }
  counts_.reject(cause);
  return false;
}

bool SensorInput::accept(const Odometry& odometry) {
  const bool continues_last = !last_odometry_ || continues(odometry);
  const bool continues_new = new_odometry_ && odometry.seq >= new_odometry_->seq &&
                             is_near(odometry.stamp, new_odometry_->stamp);
  if (!continues_last && !continues_new) {
    new_odometry_ = odometry;
    return false;
  }
  // A driver that restarts after a few messages soon has the number of the last one again.
  odometry_restarted_ = continues_new && new_odometry_->seq < last_odometry_->seq &&
                        (!continues_last || odometry.seq == last_odometry_->seq);
  new_odometry_.reset();
  seq_before_ = last_odometry_ ? last_odometry_->seq : odometry.seq;
  last_odometry_ = odometry;
  return true;
}

// Whether a message is of the same sequence as the last one. A number between those of the last
// two was overtaken: by a message that came early, or that somebody else sent.
bool SensorInput::continues(const Odometry& odometry) const {
  const bool is_next = odometry.seq >= last_odometry_->seq || odometry.seq > seq_before_;
  return is_next && is_near(odometry.stamp, last_odometry_->stamp);
}

}  // namespace nodmap::node
