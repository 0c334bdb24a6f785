// SPDX-License-Identifier: BSD-3-Clause
#include "modules/pitch_controller/area_of_interest.hpp"

#include <algorithm>

namespace nodmap::pitch_controller {

PitchInterval area_of_interest(double forward_mps, double fast_mps,
                               const PitchInterval& corridor_area, const PitchInterval& mechanics) {
  const double slowness = std::clamp(1.0 - forward_mps / fast_mps, 0.0, 1.0);
  const double around = slowness * slowness;
  const double min_rad = std::max(corridor_area.min_rad, mechanics.min_rad);
  const double max_rad = std::min(corridor_area.max_rad, mechanics.max_rad);
  return {min_rad + around * (mechanics.min_rad - min_rad),
          max_rad + around * (mechanics.max_rad - max_rad)};
}

}  // namespace nodmap::pitch_controller
