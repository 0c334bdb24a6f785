// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/surroundings/scan_gap.hpp"

#include <cstdlib>

namespace nodmap::navigator {

bool ScanGap::begin() {
  is_open_ = !ended_at_sweep_;
  return is_open_;
}

void ScanGap::update(std::int64_t sweep_count) {
  if (is_open_) {
    is_open_ = false;
    ended_at_sweep_ = sweep_count;
  }
  if (ended_at_sweep_ && std::abs(sweep_count - *ended_at_sweep_) >= sweeps_) {
    ended_at_sweep_.reset();
  }
}

}  // namespace nodmap::navigator
