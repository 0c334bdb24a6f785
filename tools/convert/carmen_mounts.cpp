// SPDX-License-Identifier: BSD-3-Clause
#include "tools/convert/carmen_mounts.hpp"

#include <cmath>

#include "tools/convert/fields.hpp"

namespace nodmap::convert {
namespace {

// Logs with three decimals round both poses by half a millimetre in each axis.
constexpr double kSameOffsetM = 0.002;
constexpr double kSameOffsetRad = 0.002;
// A larger offset means that the poses are in different frames.
constexpr double kLargestOffsetM = 2.0;

double rounded(double value) {
  return std::round(value * 1e4) / 1e4 + 0.0;  // + 0.0: no negative zero
}

bool is_mount(const geometry::SE2& T_base_laser, LaserSide side) {
  const bool looks_back = std::abs(T_base_laser.yaw) > 0.5 * geometry::kPi;
  return T_base_laser.translation().norm() < kLargestOffsetM &&
         looks_back == (side == LaserSide::kRear);
}

bool same_offset(const geometry::SE2& a, const geometry::SE2& b) {
  return (a.translation() - b.translation()).norm() < kSameOffsetM &&
         std::abs(geometry::angle_difference(a.yaw, b.yaw)) < kSameOffsetRad;
}

}  // namespace

void CarmenMounts::add(const CarmenScan& scan) {
  Side& side = sides_[static_cast<std::size_t>(scan.side)];
  const geometry::SE2 T_base_laser = scan.T_odom_base.inverse() * scan.T_odom_laser;
  if (!side.first_offset) {
    side.first_offset = T_base_laser;
    side.agree = is_mount(T_base_laser, scan.side);
  }
  side.agree = side.agree && same_offset(T_base_laser, *side.first_offset);
}

void CarmenMounts::add(const CarmenParameter& parameter) {
  Fields value(parameter.value);
  const double offset_m = value.finite();
  if (!value.ok()) {
    return;
  }
  if (parameter.name == "robot_frontlaser_offset") {
    sides_[static_cast<std::size_t>(LaserSide::kFront)].parameter_m = offset_m;
  } else if (parameter.name == "robot_rearlaser_offset") {
    sides_[static_cast<std::size_t>(LaserSide::kRear)].parameter_m = offset_m;
  }
}

geometry::SE2 CarmenMounts::mount(LaserSide side) const {
  if (!is_from_scans(side)) {
    return {of(side).parameter_m, 0.0, side == LaserSide::kRear ? geometry::kPi : 0.0};
  }
  const geometry::SE2& found = *of(side).first_offset;
  const double yaw_rad = rounded(found.yaw);
  const bool straight_back = std::abs(std::abs(yaw_rad) - geometry::kPi) < 1e-4;
  return {rounded(found.x), rounded(found.y), straight_back ? geometry::kPi : yaw_rad};
}

bool CarmenMounts::is_from_scans(LaserSide side) const {
  return of(side).first_offset && of(side).agree;
}

}  // namespace nodmap::convert
