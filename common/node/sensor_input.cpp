// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/sensor_input.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/geometry/angle.hpp"
#include "common/geometry/time.hpp"
#include "common/node/messages.hpp"
#include "common/scan/ego_map_points.hpp"

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

// How far a pose may be from the one before: by the speeds of the message, and because some bases
// report none, 6 m/s and 8 rad/s more. The constant parts are for stamps that jitter. Every 10 ms
// it is 0.16 m and 11 degrees. No message of intel, fr079 and mit-csail is beyond it.
constexpr double kStepM = 0.1;
constexpr double kStepRad = geometry::deg_to_rad(6.0);
constexpr double kUnreportedMps = 6.0;
constexpr double kUnreportedRadS = 8.0;
constexpr time::Duration kLongestPeriod = 1s;

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

std::optional<std::vector<Eigen::Vector2d>> SensorInput::read(const nodmap::egomap_t& message) {
  if (!follows(structure_map_sender_, "other_sender_of_structure_map")) {
    return std::nullopt;
  }
  auto points_base =
      scan::read_ego_map_points(message.distance_m, message.point_x_m, message.point_y_m);
  if (!points_base || !time::is_plausible(stamp_of(message))) {
    counts_.reject("implausible_structure_map");
    return std::nullopt;
  }
  return points_base;
}

std::optional<geometry::SE3> SensorInput::read(const nodmap::odometry_t& message) {
  if (!follows(odometry_sender_, "other_sender_of_odometry")) {
    return std::nullopt;
  }
  counts_.lose(odometry_.lost_before(message.odometry_seq));
  auto T_odom_base = read_odometry(message);
  const time::Timestamp stamp = time::from_utime(message.utime);
  if (!T_odom_base || !time::is_plausible(stamp) || !has_plausible_speeds(message)) {
    counts_.reject("implausible_odometry");
    return std::nullopt;
  }
  if (!accept({message.odometry_seq, stamp, *T_odom_base, message.forward_mps,
               message.yaw_rate_rad_s})) {
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
  const bool continues_new =
      new_odometry_ && odometry.seq >= new_odometry_->seq && can_follow(odometry, *new_odometry_);
  if (!continues_last && !continues_new) {
    new_odometry_ = odometry;
    return false;
  }
  const bool has_jumped = continues_new && !is_reachable(*new_odometry_, *last_odometry_);
  // A driver that restarts after a few messages soon has the number of the last one again.
  const bool has_restarted = continues_new && new_odometry_->seq < last_odometry_->seq &&
                             (!continues_last || odometry.seq == last_odometry_->seq);
  odometry_restarted_ = has_jumped || has_restarted;
  if (!first_odometry_ || odometry_restarted_ || odometry.seq <= first_odometry_->seq) {
    first_odometry_ = odometry;
  }
  odometry_lost_ = lost_before(odometry);
  new_odometry_.reset();
  seq_before_ = last_odometry_ ? last_odometry_->seq : odometry.seq;
  const time::Duration period =
      last_odometry_ ? std::chrono::abs(odometry.stamp - last_odometry_->stamp) : 0us;
  last_odometry_ = odometry;
  last_odometry_->period = std::min(period, kLongestPeriod);
  return true;
}

// The messages that are missing, at the mean period of the sequence so far. That of a driver that
// has restarted unnoticed is too young to explain the time since the last message.
time::Duration SensorInput::lost_before(const Odometry& odometry) const {
  if (!last_odometry_ || odometry_restarted_ || last_odometry_->seq <= first_odometry_->seq ||
      odometry.seq <= last_odometry_->seq) {
    return {};
  }
  const auto messages_since = [](const Odometry& later, const Odometry& earlier) {
    return static_cast<double>(later.seq) - static_cast<double>(earlier.seq);
  };
  const time::Duration time_before = last_odometry_->stamp - first_odometry_->stamp;
  const double period_s =
      time::seconds(time_before) / messages_since(*last_odometry_, *first_odometry_);
  const time::Duration elapsed = odometry.stamp - last_odometry_->stamp;
  const double lost_s = (messages_since(odometry, *last_odometry_) - 1.0) * period_s;
  return std::clamp(time::from_seconds(lost_s), time::Duration{},
                    std::max(elapsed, time::Duration{}));
}

// Whether a message is of the same sequence as the last one. A number between those of the last
// two was overtaken: by a message that came early, or that somebody else sent.
bool SensorInput::continues(const Odometry& odometry) const {
  const bool is_next = odometry.seq >= last_odometry_->seq || odometry.seq > seq_before_;
  return is_next && can_follow(odometry, *last_odometry_);
}

// Whether two successive messages of one driver can have these stamps and poses, if neither clock
// nor pose was set.
bool SensorInput::can_follow(const Odometry& odometry, const Odometry& other) {
  return std::chrono::abs(odometry.stamp - other.stamp) <= kLongestGap &&
         is_reachable(odometry, other);
}

// A message that is stamped late bears nearly the stamp of the next one, so the period before it
// counts as well.
bool SensorInput::is_reachable(const Odometry& odometry, const Odometry& other) {
  const double elapsed_s =
      time::seconds(std::max(std::chrono::abs(odometry.stamp - other.stamp), other.period));
  return geometry::distance_m(odometry.T_odom_base, other.T_odom_base) <=
             kStepM + elapsed_s * (kUnreportedMps + std::abs(odometry.forward_mps)) &&
         geometry::rotation_rad(odometry.T_odom_base, other.T_odom_base) <=
             kStepRad + elapsed_s * (kUnreportedRadS + std::abs(odometry.yaw_rate_rad_s));
}

}  // namespace nodmap::node
