// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/surroundings/seen_directions.hpp"

#include <cmath>

#include "common/geometry/angle.hpp"

namespace nodmap::navigator {
namespace {

std::size_t bin_of(double compass_rad, int bins) {
  const auto degree =
      static_cast<int>(std::lround(geometry::rad_to_deg(geometry::normalize_angle(compass_rad))));
  return static_cast<std::size_t>((degree + bins) % bins);
}

}  // namespace

void SeenDirections::update(double heading_rad, std::int64_t sweep_count) {
  // The servo driver has restarted its count, which cannot be compared with the old one.
  if (sweep_count < sweep_count_) {
    forget();
  }
  heading_rad_ = heading_rad;
  sweep_count_ = sweep_count;
  for (int bin = 0; bin < kBins; ++bin) {
    auto& since = in_view_since_[static_cast<std::size_t>(bin)];
    const double direction_rad = geometry::angle_difference(geometry::deg_to_rad(bin), heading_rad);
    // Half a degree more, so that rounding to bins does not make the borders flicker.
    if (std::abs(direction_rad) > view_half_rad_ + geometry::deg_to_rad(0.5)) {
      since.reset();
    } else if (!since) {
      since = sweep_count;
    }
  }
}

void SeenDirections::forget_unseen() {
  for (auto& since : in_view_since_) {
    if (!is_seen_since(since)) {
      since.reset();
    }
  }
}

bool SeenDirections::is_seen(double direction_rad) const {
  return is_seen_since(in_view_since(direction_rad));
}

bool SeenDirections::is_in_view(double direction_rad) const {
  return in_view_since(direction_rad).has_value();
}

SeenDirections::SweepCount SeenDirections::in_view_since(double direction_rad) const {
  return std::abs(direction_rad) > view_half_rad_
             ? std::nullopt
             : in_view_since_[bin_of(heading_rad_ + direction_rad, kBins)];
}

bool SeenDirections::is_seen_since(const SweepCount& since) const {
  return since && sweep_count_ - *since >= sweeps_to_trust_;
}

}  // namespace nodmap::navigator
