// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/unseen_places.hpp"

#include <algorithm>
#include <limits>

namespace nodmap::pitch_controller {
namespace {

// Of ten seconds: only a head that has stopped nodding leaves that many.
constexpr std::size_t kMaxPlaces = 500;

}  // namespace

void UnseenPlaces::advance(double moved_m, double turned_rad) {
  for (Place& place : places_) {
    place.distance_m -= moved_m;
    place.turned_rad += turned_rad;
  }
}

void UnseenPlaces::add(double protected_m) {
  if (places_.size() == kMaxPlaces) {
    const Place oldest = places_.front();
    places_.erase(places_.begin());
    Place& next = places_.front();
    next = {std::min(oldest.distance_m, next.distance_m),
            std::min(oldest.protected_m, next.protected_m),
            std::min(oldest.turned_rad, next.turned_rad)};
  }
  places_.push_back({protected_m, protected_m, 0.0});
}

void UnseenPlaces::forget_measured(const NodMotion& nod, double revisit_s) {
  std::erase_if(places_,
                [&](const Place& place) { return place.measured_after_s(nod, revisit_s) <= 0.0; });
}

double UnseenPlaces::nearest_hit_m(const NodMotion& nod, double revisit_s,
                                   double forward_mps) const {
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Place& place : places_) {
    const double after_s = place.measured_after_s(nod, revisit_s);
    nearest_m = std::min(nearest_m, place.distance_m - forward_mps * std::max(after_s, 0.0));
  }
  return nearest_m;
}

double UnseenPlaces::least_protected_m() const {
  double least_m = std::numeric_limits<double>::infinity();
  for (const Place& place : places_) {
    least_m = std::min(least_m, place.protected_m);
  }
  return least_m;
}

}  // namespace nodmap::pitch_controller
