// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/pace.hpp"

#include <algorithm>

namespace nodmap::viewer {

void Pace::note_load(float share) {
  if (share >= kBusyShare) {
    period_ = std::max(fastest_, std::min(2 * period_, kSlowest));
  } else if (share < kRoomShare) {
    // More slowly than it grew, to avoid oscillation.
    period_ = std::max(fastest_, period_ * 3 / 4);
  }
}

bool Pace::take_update(time::SteadyTime now) {
  if (is_slowed() && now < due_) {
    return false;
  }
  due_ = now + period_;
  return true;
}

}  // namespace nodmap::viewer
