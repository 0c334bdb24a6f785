// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/local_map/low_hits.hpp"

#include <algorithm>

namespace nodmap::navigator {
namespace {

// Beams that end farther apart have hit two objects.
constexpr double kSideBySideM = 0.1;
// A line is measured at most this much below the floor: 0.6 degrees at 1.3 m, when the robot
// brakes.
constexpr double kLineErrorM = 0.015;
// Six standard deviations of a range: one beam in a thousand million has this error.
constexpr double kRangeErrorM = 0.06;

}  // namespace

void LowHits::begin_scan(std::size_t num_beams) {
  low_.clear();
  floor_.clear();
  line_floor_.begin_scan(num_beams);
}

void LowHits::add_floor(const Hit& hit) {
  floor_.push_back(hit);
  line_floor_.add(hit.beam, hit.height_m);
}

// What is within the tolerance is floor, unless it stands out of its line.
//
// Where two beams side by side end above the tolerance, and higher than by the noise of their
// ranges, there is something: the errors of pitch and tilt that they share are within the
// tolerance. So a low sill is known from a single line on it; the next one is a cell or more
// farther on. A brick of 3 cm has only one beam on it, which counts alone if it stands out of its
// line by more than the noise of a range. What may be the noise of a steep beam is neither floor
// nor obstacle.
void LowHits::end_scan(bool is_level, LocalGrid& grid, FloorEvidence& floor,
                       const ObstacleMemory& obstacles, std::uint16_t scan) {
  is_level_ = is_level;
  for (const Hit& hit : floor_) {
    if (is_above_line(hit)) {
      low_.push_back(hit);
    } else {
      floor.add(grid, hit.beam, hit.p_odom.head<2>(), hit.p_odom.z() - hit.height_m, scan);
    }
  }
  std::ranges::sort(low_, {}, &Hit::beam);
  const auto are_side_by_side = [this](std::size_t a, std::size_t b) {
    return b < low_.size() && low_[a].beam + 1 == low_[b].beam &&
           (low_[b].p_odom - low_[a].p_odom).norm() < kSideBySideM && is_above_noise(low_[a]) &&
           is_above_noise(low_[b]);
  };
  bool is_beside_last = false;
  for (std::size_t i = 0; i < low_.size(); ++i) {
    const bool is_beside_next = are_side_by_side(i, i + 1);
    const bool is_certain = is_beside_last || is_beside_next || is_above_line(low_[i]);
    if (is_certain || is_above_noise(low_[i])) {
      obstacles.add_hit(grid, low_[i].p_odom, is_certain, scan);
    }
    is_beside_last = is_beside_next;
  }
}

bool LowHits::is_above_noise(const Hit& hit) {
  return hit.height_m > evidence::range_noise_m(hit.sinking);
}

bool LowHits::is_above_line(const Hit& hit) const {
  const double least_m = std::max(floor_tolerance_m_, kRangeErrorM * hit.sinking);
  if (!is_level_ || hit.height_m < least_m - kLineErrorM) {
    return false;
  }
  const auto level_m = line_floor_.level_around(hit.beam);
  return level_m && hit.height_m - *level_m > least_m;
}

}  // namespace nodmap::navigator
