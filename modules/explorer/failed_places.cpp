// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/failed_places.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::explorer {
namespace {

/// Places nearer to each other than this count as one.
constexpr double kSamePlaceM = 0.7;

}  // namespace

void FailedPlaces::add(const Eigen::Vector2d& p_map, time::Timestamp now) {
  auto place = std::ranges::find_if(
      places_, [&](const Place& known) { return (known.p_map - p_map).norm() < kSamePlaceM; });
  if (place == places_.end()) {
    place = places_.insert(places_.end(), {p_map, 0, {}});
  }
  const double pause_s = params_.retry_s * std::exp2(place->num_failures++);
  place->until = now + time::from_seconds(pause_s);
}

bool FailedPlaces::is_left_out(const Eigen::Vector2d& p_map, time::Timestamp now) const {
  return std::ranges::any_of(places_, [&](const Place& place) {
    return (place.p_map - p_map).norm() < kSamePlaceM &&
           (now < place.until || place.num_failures >= params_.max_failures);
  });
}

bool FailedPlaces::forgive() {
  bool any = false;
  for (Place& place : places_) {
    any = any || (place.num_failures < params_.max_failures && place.until != time::Timestamp{});
    place.until = {};
  }
  return any;
}

}  // namespace nodmap::explorer
