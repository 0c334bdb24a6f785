// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/level_scanner_node.hpp"

#include <limits>
#include <nlohmann/json.hpp>

#include "common/geometry/angle.hpp"
#include "common/node/messages.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "tools/trial/record.hpp"

namespace nodmap::trial {
namespace {

// Like the two constants of the class: a Hokuyo UST-10LX. It measures during three quarters of each
// revolution.
constexpr time::Duration kMeasuringTime = 18'750us;
constexpr std::size_t kBeams = 720;
constexpr double kApertureRad = geometry::deg_to_rad(270.0);
constexpr double kRangeMinM = 0.06;
// Time until the first scan.
constexpr time::Duration kBootTime = 1s;

}  // namespace

LevelScannerNode::LevelScannerNode(node::Context& context, const robot::Mount& mount,
                                   sim::RobotModel& model)
    : context_(context), mount_(mount), model_(model), next_scan_(model.now() + kBootTime) {}

void LevelScannerNode::spin_once() {
  const time::SteadyTime now = model_.now();
  if (now < next_scan_) {
    return;
  }
  publish_pitch(now);
  publish_scan(now);
  ++seq_;
  next_scan_ += kScanPeriod;
}

void LevelScannerNode::publish_scan(time::SteadyTime end) {
  scan::Scan scan;
  scan.stamp = stamp_at(end - kMeasuringTime);
  scan.duration = kMeasuringTime;
  scan.seq = seq_;
  scan.angle_first_rad = -0.5 * kApertureRad;
  scan.angle_step_rad = kApertureRad / static_cast<double>(kBeams - 1);
  scan.range_min_m = kRangeMinM;
  scan.range_max_m = kRangeMaxM;
  scan.T_base_mount.translation() << mount_.x_m, mount_.y_m, mount_.z_m;
  scan.ranges_m.resize(kBeams);
  for (std::size_t beam = 0; beam < kBeams; ++beam) {
    const auto since_first = std::chrono::duration_cast<time::Duration>(
        scan.fraction(beam) * time::FineDuration(kMeasuringTime));
    const sim::Echo echo = model_.measure(scan.angle_rad(beam), end - kMeasuringTime + since_first);
    scan.ranges_m[beam] = echo.kind == sim::Echo::Kind::kRange
                              ? static_cast<float>(echo.range_m)
                              : std::numeric_limits<float>::infinity();
  }
  context_.bus.publish("SCAN", node::write_scan(scan));
}

void LevelScannerNode::publish_pitch(time::SteadyTime now) {
  nodmap::pitch_state_t message{};
  message.utime = time::to_utime(stamp_at(now));
  message.state_seq = seq_;
  message.pitch_is_measured = 1;
  context_.bus.publish("PITCH_STATE", message);
}

nlohmann::json LevelScannerNode::metrics() const {
  return {{"scans", seq_}};
}

}  // namespace nodmap::trial
