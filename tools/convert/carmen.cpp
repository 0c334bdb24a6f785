// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/carmen.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tools/convert/fields.hpp"

namespace nodmap::convert {
namespace {

geometry::SE2 read_pose(Fields& fields) {
  const double x = fields.finite();
  const double y = fields.finite();
  return {x, y, geometry::normalize_angle(fields.finite())};
}

// Reads `ipc_timestamp host logger_timestamp` at the end of the line. A wrong count of readings is
// detected by the remaining words.
time::Timestamp read_trailer(Fields& fields) {
  const time::Timestamp stamp = fields.stamp();
  fields.word();
  fields.finite();
  return stamp;
}

void mark_no_returns(std::vector<float>& ranges_m, double no_return_m) {
  const auto limit_m = static_cast<float>(no_return_m);  // converted as the readings are
  for (float& range_m : ranges_m) {
    if (range_m >= limit_m) {
      range_m = std::numeric_limits<float>::infinity();
    }
  }
}

template <class Value>
CarmenLine finished(const Fields& fields, Value value) {
  if (!fields.ok()) {
    return CarmenUnreadable{"a number is missing or damaged"};
  }
  if (!fields.at_end()) {
    return CarmenUnreadable{"more words than its counts imply"};
  }
  return value;
}

CarmenLine parse_odometry(Fields fields) {
  CarmenOdometry odometry;
  odometry.T_odom_base = read_pose(fields);
  odometry.forward_mps = fields.finite();
  odometry.yaw_rate_rad_s = fields.finite();
  fields.finite();  // acceleration
  odometry.stamp = read_trailer(fields);
  return finished(fields, odometry);
}

// `n r1..rn x y theta odom_x odom_y odom_theta`
CarmenLine parse_plain_scan(Fields fields, LaserSide side) {
  CarmenScan scan;
  scan.side = side;
  const std::size_t num_beams = fields.count();
  if (num_beams < 2) {
    return CarmenUnreadable{"fewer than two beams"};
  }
  const CarmenFan fan = carmen_fan(num_beams);
  scan.angle_first_rad = fan.angle_first_rad;
  scan.angle_step_rad = fan.angle_step_rad;
  scan.ranges_m = fields.numbers(num_beams);
  mark_no_returns(scan.ranges_m, kCarmenNoReturnM);
  scan.T_odom_laser = read_pose(fields);
  scan.T_odom_base = read_pose(fields);
  scan.stamp = read_trailer(fields);
  return finished(fields, std::move(scan));
}

// `type start_angle fov ang_res max_range accuracy remission_mode n r1..rn n_rem rem.. laser pose
// robot pose tv rv forward_safety side_safety turn_axis`
CarmenLine parse_described_scan(Fields fields) {
  CarmenScan scan;
  fields.word();
  scan.angle_first_rad = fields.finite();
  fields.finite();
  scan.angle_step_rad = fields.finite();
  const double max_range_m = fields.finite();
  fields.finite();
  fields.finite();
  if (max_range_m > 0.0) {
    scan.range_max_m = std::min(max_range_m, kCarmenNoReturnM);
  }
  scan.ranges_m = fields.numbers(fields.count());
  mark_no_returns(scan.ranges_m, scan.range_max_m);
  scan.intensities = fields.numbers(fields.count());
  scan.T_odom_laser = read_pose(fields);
  scan.T_odom_base = read_pose(fields);
  const double mount_yaw_rad =
      geometry::angle_difference(scan.T_odom_laser.yaw, scan.T_odom_base.yaw);
  scan.side = std::abs(mount_yaw_rad) > 0.5 * geometry::kPi ? LaserSide::kRear : LaserSide::kFront;
  for (int i = 0; i < 5; ++i) {
    fields.finite();
  }
  scan.stamp = read_trailer(fields);
  if (fields.ok() && (scan.ranges_m.size() < 2 || scan.angle_step_rad <= 0.0)) {
    return CarmenUnreadable{"fewer than two beams, or no angle between them"};
  }
  return finished(fields, std::move(scan));
}

}  // namespace

CarmenFan carmen_fan(std::size_t num_beams) {
  // 401 beams are the finest fan of a SICK: 100 degrees in steps of a quarter. Every other count
  // spans 180 degrees; with an even count (180, 360) the last beam is missing.
  if (num_beams == 401) {
    return {geometry::deg_to_rad(-50.0), geometry::deg_to_rad(0.25)};
  }
  const std::size_t num_steps = num_beams % 2 == 0 ? num_beams : num_beams - 1;
  return {geometry::deg_to_rad(-90.0),
          geometry::deg_to_rad(180.0 / static_cast<double>(num_steps))};
}

CarmenLine parse_carmen_line(std::string_view line) {
  Fields fields(line);
  const std::string_view name = fields.word();
  if (name.empty() || name.starts_with('#')) {
    return CarmenOther{};
  }
  if (name == "ODOM") {
    return parse_odometry(fields);
  }
  if (name == "FLASER") {
    return parse_plain_scan(fields, LaserSide::kFront);
  }
  if (name == "RLASER") {
    return parse_plain_scan(fields, LaserSide::kRear);
  }
  if (name == "ROBOTLASER1") {
    return parse_described_scan(fields);
  }
  if (name == "PARAM") {
    const std::string_view parameter = fields.word();
    return CarmenParameter{std::string(parameter), std::string(fields.word())};
  }
  return CarmenOther{std::string(name)};
}

}  // namespace nodmap::convert
