// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/left_out_places.hpp"

#include <algorithm>
#include <cmath>

namespace nodmap::explorer {

void LeftOutPlaces::add(const Eigen::Vector2d& p_map, time::Timestamp now) {
  auto place = std::ranges::find_if(
      places_, [&](const Place& known) { return (known.p_map - p_map).norm() < same_place_m_; });
  if (place == places_.end()) {
    place = places_.insert(places_.end(), {.p_map = p_map});
  }
  place->since = now;
  place->pause = time::from_seconds(pause_s_ * std::exp2(place->num_tries++));
}

bool LeftOutPlaces::excludes(const Eigen::Vector2d& p_map, time::Timestamp now) const {
  return std::ranges::any_of(places_, [&](const Place& place) {
    return (place.p_map - p_map).norm() < same_place_m_ &&
           (std::chrono::abs(now - place.since) < place.pause || place.num_tries >= max_tries_);
  });
}

bool LeftOutPlaces::permit_retries() {
  bool any = false;
  for (Place& place : places_) {
    any = any || (place.num_tries < max_tries_ && place.pause != time::Duration{});
    place.pause = {};
  }
  return any;
}

std::size_t LeftOutPlaces::num_given_up() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      places_, [this](const Place& place) { return place.num_tries >= max_tries_; }));
}

}  // namespace nodmap::explorer
