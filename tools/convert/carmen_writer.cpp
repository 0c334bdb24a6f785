// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/carmen_writer.hpp"

#include <algorithm>
#include <charconv>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

namespace nodmap::convert {
namespace {

// The marker for "no echo" in the public logs.
constexpr float kNoReturnMarkerM = 81.91F;

// Writes the words of a line, separated by blanks.
class LineWriter {
 public:
  explicit LineWriter(std::string name) : text_(std::move(name)) {}

  // Writes as many digits as are necessary to read the same number again.
  template <class Number>
  void exact(Number value) {
    char digits[40];
    const char* end = std::to_chars(digits, digits + sizeof digits, value).ptr;
    text_.push_back(' ');
    text_.append(std::string_view(digits, end));
  }
  // Writes six decimals, as CARMEN does.
  void rounded(double value) {
    char digits[400];  // the longest double has 309 digits before the point
    const char* end =
        std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed, 6).ptr;
    text_.push_back(' ');
    text_.append(std::string_view(digits, end));
  }
  void pose(const geometry::SE2& pose) {
    rounded(pose.x);
    rounded(pose.y);
    rounded(pose.yaw);
  }
  void ranges(const CarmenScan& scan, float no_return_m) {
    exact(scan.ranges_m.size());
    for (const float range_m : scan.ranges_m) {
      exact(std::isinf(range_m) ? no_return_m : range_m);
    }
  }
  // `ipc_timestamp host logger_timestamp`
  std::string finish(time::Timestamp stamp, time::Timestamp start) && {
    const std::int64_t utime = time::to_utime(stamp);
    char trailer[64];
    std::snprintf(trailer, sizeof trailer, " %" PRId64 ".%06d nodmap", utime / 1'000'000,
                  static_cast<int>(utime % 1'000'000));
    text_.append(trailer);
    rounded(time::seconds(stamp - start));
    return std::move(text_);
  }

 private:
  std::string text_;
};

bool fits_plain_line(const CarmenScan& scan) {
  const CarmenFan fan = carmen_fan(scan.ranges_m.size());
  constexpr double kSameAngleRad = 1e-9;
  return scan.ranges_m.size() >= 2 && scan.intensities.empty() &&
         scan.range_max_m == kCarmenNoReturnM &&
         std::abs(scan.angle_first_rad - fan.angle_first_rad) < kSameAngleRad &&
         std::abs(scan.angle_step_rad - fan.angle_step_rad) < kSameAngleRad;
}

// The same scan, from its last beam to its first.
CarmenScan reversed(CarmenScan scan) {
  scan.angle_first_rad += scan.angle_step_rad * static_cast<double>(scan.ranges_m.size() - 1);
  scan.angle_step_rad = -scan.angle_step_rad;
  std::ranges::reverse(scan.ranges_m);
  std::ranges::reverse(scan.intensities);
  return scan;
}

}  // namespace

std::string write_carmen_line(const CarmenOdometry& odometry, time::Timestamp start) {
  LineWriter line("ODOM");
  line.pose(odometry.T_odom_base);
  line.rounded(odometry.forward_mps);
  line.rounded(odometry.yaw_rate_rad_s);
  line.rounded(0.0);
  return std::move(line).finish(odometry.stamp, start);
}

std::string write_carmen_line(const CarmenScan& scan, time::Timestamp start) {
  if (scan.angle_step_rad < 0.0 && !scan.ranges_m.empty()) {  // a laser that is upside down
    return write_carmen_line(reversed(scan), start);          // CARMEN's beams go to the left
  }
  if (fits_plain_line(scan)) {
    LineWriter line(scan.side == LaserSide::kFront ? "FLASER" : "RLASER");
    line.ranges(scan, kNoReturnMarkerM);
    line.pose(scan.T_odom_laser);
    line.pose(scan.T_odom_base);
    return std::move(line).finish(scan.stamp, start);
  }
  LineWriter line("ROBOTLASER1");
  line.exact(0);
  line.exact(scan.angle_first_rad);
  line.exact(scan.angle_step_rad * static_cast<double>(scan.ranges_m.size() - 1));
  line.exact(scan.angle_step_rad);
  line.exact(scan.range_max_m);
  line.exact(0);
  line.exact(0);
  line.ranges(scan, static_cast<float>(scan.range_max_m));
  line.exact(scan.intensities.size());
  for (const float intensity : scan.intensities) {
    line.exact(intensity);
  }
  line.pose(scan.T_odom_laser);
  line.pose(scan.T_odom_base);
  for (int i = 0; i < 5; ++i) {
    line.exact(0);
  }
  return std::move(line).finish(scan.stamp, start);
}

}  // namespace nodmap::convert
