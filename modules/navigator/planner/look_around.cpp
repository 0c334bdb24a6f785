// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/planner/look_around.hpp"

#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace {

constexpr time::Duration kLookAfter = 1s;
constexpr time::Duration kLookAgainAfter = 30s;
constexpr double kAllAroundRad = 2.0 * geometry::kPi;

}  // namespace

bool LookAround::step(time::Timestamp stamp, double yaw_rad) {
  // The magnitude counts: a clock that is set back must not keep the robot from looking.
  const bool begins_again = began_at_ && std::chrono::abs(stamp - *began_at_) > kLookAgainAfter;
  if (begins_again) {
    reset();
  }
  if (!began_at_) {
    began_at_ = stamp;
    last_yaw_rad_ = yaw_rad;
    rotated_rad_ = 0.0;
  }
  lasted_ = std::chrono::abs(stamp - *began_at_);
  rotated_rad_ += std::abs(geometry::angle_difference(yaw_rad, last_yaw_rad_));
  last_yaw_rad_ = yaw_rad;
  return begins_again;
}

bool LookAround::wants_rotation() const {
  return lasted_ > kLookAfter && rotated_rad_ < kAllAroundRad;
}

void LookAround::end() {
  rotated_rad_ = kAllAroundRad;
}

bool LookAround::take_end() {
  if (rotated_rad_ < kAllAroundRad || end_is_taken_) {
    return false;
  }
  end_is_taken_ = true;
  return true;
}

}  // namespace nodmap::navigator
