// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/message_input.hpp"

#include <chrono>
#include <string>
#include <utility>

#include "common/geometry/time.hpp"
#include "common/node/log.hpp"
#include "common/node/messages.hpp"

namespace nodmap::node {
namespace {

// The year 38000. Sums and differences of smaller stamps never overflow.
constexpr time::Timestamp kLatestStamp(time::kLimit / 2);
// Far above the duration of any laser's mirror revolution.
constexpr time::Duration kLongestScan = 60s;

bool is_plausible(time::Timestamp stamp) {
  return stamp >= time::Timestamp{} && stamp < kLatestStamp;
}

}  // namespace

bool SensorInput::read(const nodmap::scan_t& message, scan::Scan& scan) {
  counts_.lose(scans_.lost_before(message.scan_seq));
  if (!read_scan(message, scan) || !is_plausible(scan.stamp) || scan.duration > kLongestScan) {
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
  sequence_fell_ = sequence_fell_ || odometry_.falls_back(message.odometry_seq);
  counts_.lose(odometry_.lost_before(message.odometry_seq));
  auto T_odom_base = read_odometry(message);
  if (!T_odom_base || !is_plausible(time::from_utime(message.utime))) {
    counts_.reject("implausible_odometry");
    return std::nullopt;
  }
  odometry_restarted_ = std::exchange(sequence_fell_, false);
  return T_odom_base;
}

bool SaveRequests::accept(const nodmap::save_request_t& request, const Context& context,
                          time::Timestamp now) {
  if (context.out_dir.empty()) {
    context.counts.reject("save_request_without_out_dir");
    return false;
  }
  const std::string name = read_name(request.requested_by);
  if (accepted_ && std::chrono::abs(now - *accepted_) < kPeriod) {
    context.counts.reject("save_request_too_soon");
    if (!std::exchange(has_logged_refusal_, true)) {
      log::get().warn("{} asked to save the map again within {} s: refused", name, kPeriod / 1s);
    }
    return false;
  }
  accepted_ = now;
  has_logged_refusal_ = false;
  context.counts.use();
  log::get().info("{} asked to save the map", name);
  return true;
}

}  // namespace nodmap::node
