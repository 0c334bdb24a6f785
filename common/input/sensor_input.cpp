// SPDX-License-Identifier: BSD-3-Clause
#include "common/input/sensor_input.hpp"

#include <utility>

#include "common/msg/messages.hpp"

namespace nodmap::input {
namespace {

// A microsecond clock gets there in the year 38000; sums and differences of stamps below never
// overflow.
constexpr std::int64_t kLatestUtimeUs = std::int64_t{1} << 60;
// A mirror that takes a minute for a turn is none.
constexpr std::int64_t kLongestScanUs = 60'000'000;

bool is_time(std::int64_t utime_us) {
  return utime_us >= 0 && utime_us < kLatestUtimeUs;
}

}  // namespace

bool SensorInput::read(const nodmap::scan_t& message, scan::Scan& scan) {
  tally_.lose(scans_.lost_before(message.scan_seq));
  if (!msg::read_scan(message, scan) || !is_time(scan.utime_us) ||
      scan.duration_us > kLongestScanUs) {
    tally_.reject("implausible_scan");
    return false;
  }
  if (scan.ranges_m.empty()) {
    tally_.reject("empty_scan");
    return false;
  }
  return true;
}

std::optional<geometry::SE3> SensorInput::read(const nodmap::odometry_t& message) {
  fell_back_ = fell_back_ || odometry_.falls_back(message.odometry_seq);
  tally_.lose(odometry_.lost_before(message.odometry_seq));
  auto T_odom_base = msg::read_odometry(message);
  if (!T_odom_base || !is_time(message.utime)) {
    tally_.reject("implausible_odometry");
    return std::nullopt;
  }
  odometry_began_anew_ = std::exchange(fell_back_, false);
  return T_odom_base;
}

}  // namespace nodmap::input
