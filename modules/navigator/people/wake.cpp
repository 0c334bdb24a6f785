// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/wake.hpp"

#include <algorithm>

#include "modules/navigator/local_map/local_map.hpp"

namespace nodmap::navigator {
namespace {

constexpr double kWakeS = 1.0;
// A point this near to the disc of a person belongs to the person, by the error of the track.
constexpr double kOnPersonM = 0.25;
// Obstacles this near to the disc of a person were the person, by the noise of the track.
constexpr double kTrackNoiseM = 0.1;

}  // namespace

Points without_wakes(const People& people_base, Points points_base) {
  std::erase_if(points_base, [&](const Eigen::Vector2d& p_base) {
    return std::ranges::any_of(people_base, [&](const Person& person) {
      return person.is_in_sight &&
             distance_to_path(p_base, person, 0.0, -kWakeS) < person.radius_m + kOnPersonM;
    });
  });
  return points_base;
}

void forget_wakes(const People& people_odom, LocalMap& local_map) {
  constexpr double kForgetEveryS = 0.2;
  for (const Person& person : people_odom) {
    for (double ago_s = 0.0; ago_s <= kWakeS && person.is_in_sight; ago_s += kForgetEveryS) {
      local_map.forget_walker(person.position_after(-ago_s), person.radius_m + kTrackNoiseM);
    }
  }
}

}  // namespace nodmap::navigator
