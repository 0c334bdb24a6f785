// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/gyro_doubt.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::kurt {
namespace {

using geometry::deg_to_rad;

// How far the robot's rotation can differ from that of its wheels. They may spin while an obstacle
// holds the robot, and on a floor on which they do not skid they rotate it by 1 /
// turning_adaptation = 1.45 times as much. The rest is for slip (1.6 degrees per metre in the
// simulator, one sigma) and for the time of the angle, which is known to 10 ms: 1.1 degrees at 2
// rad/s.
constexpr double kSummedS = 1.0;
constexpr double kMaxRotation = 1.5;
constexpr double kMarginRad = deg_to_rad(3.0);
constexpr double kMarginRadPerM = deg_to_rad(10.0);
// How far a gyro that has disagreed must rotate with the wheels until it is trusted again.
constexpr double kAgreedRad = deg_to_rad(20.0);

bool are_plausible(const GyroDoubt::Rotations& rotations) {
  const double margin_rad = kMarginRad + kMarginRadPerM * rotations.path_m;
  const double most_rad = kMaxRotation * rotations.wheels_rad;
  return rotations.gyro_rad >= std::min(0.0, most_rad) - margin_rad &&
         rotations.gyro_rad <= std::max(0.0, most_rad) + margin_rad;
}

}  // namespace

void GyroDoubt::add(const Rotations& rotations, double dt_s) {
  const double keep = std::exp(-dt_s / kSummedS);
  sums_ = {keep * sums_.gyro_rad + rotations.gyro_rad,
           keep * sums_.wheels_rad + rotations.wheels_rad, keep * sums_.path_m + rotations.path_m};
  update(rotations, are_plausible(rotations) && are_plausible(sums_));
  if (!are_plausible(rotations)) {
    sums_ = {};  // a jump says nothing about the rotations before and after it
  }
}

// A gyro of the wrong sign disagrees only while the robot rotates, so it is trusted again only once
// it has followed rotations.
void GyroDoubt::update(const Rotations& rotations, bool is_plausible) {
  if (!is_plausible) {
    is_active_ = true;
    agreed_rad_ = 0.0;
  } else if (is_active_) {
    const double common_rad =
        std::min(std::abs(rotations.gyro_rad), std::abs(rotations.wheels_rad));
    agreed_rad_ = std::max(
        agreed_rad_ + std::copysign(common_rad, rotations.gyro_rad * rotations.wheels_rad), 0.0);
    is_active_ = agreed_rad_ < kAgreedRad;
  }
}

}  // namespace nodmap::kurt
