// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/people/legs.hpp"

#include <algorithm>
#include <optional>

namespace nodmap::navigator {
namespace {

// The legs of a person who walks are at most this far apart, at the height of knees.
constexpr double kLegsApartM = 0.5;
// The body above two legs.
constexpr double kBodyRadiusM = 0.25;
// A single leg needs this many beams, and so does one of a pair: mixed pixels at an edge are one or
// two.
constexpr std::size_t kMinBeamsOfLeg = 3;

struct Pair {
  std::size_t first;
  std::size_t second;
};

// The two legs that are nearest to each other.
std::optional<Pair> nearest_legs(const std::vector<Detection>& detections) {
  std::optional<Pair> nearest;
  double least_m = kLegsApartM;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    for (std::size_t j = i + 1; j < detections.size(); ++j) {
      const double apart_m = (detections[i].p_odom - detections[j].p_odom).norm();
      const bool is_certain =
          std::max(detections[i].num_beams, detections[j].num_beams) >= kMinBeamsOfLeg;
      if (is_certain && detections[i].num_legs == 1 && detections[j].num_legs == 1 &&
          apart_m < least_m) {
        least_m = apart_m;
        nearest = Pair{i, j};
      }
    }
  }
  return nearest;
}

Detection joined(const Detection& a, const Detection& b) {
  Detection person;
  person.p_odom = 0.5 * (a.p_odom + b.p_odom);
  person.radius_m = kBodyRadiusM;
  person.lowest_m = std::min(a.lowest_m, b.lowest_m);
  person.highest_m = std::max(a.highest_m, b.highest_m);
  person.free_ratio = std::min(a.free_ratio, b.free_ratio);
  person.num_legs = 2;
  person.num_beams = a.num_beams + b.num_beams;
  return person;
}

}  // namespace

std::vector<Detection> join_legs(std::vector<Detection> detections) {
  while (const auto legs = nearest_legs(detections)) {
    detections[legs->first] = joined(detections[legs->first], detections[legs->second]);
    detections.erase(detections.begin() + static_cast<std::ptrdiff_t>(legs->second));
  }
  std::erase_if(detections,
                [](const Detection& detection) { return detection.num_beams < kMinBeamsOfLeg; });
  return detections;
}

}  // namespace nodmap::navigator
