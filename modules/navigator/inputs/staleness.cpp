// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/inputs/staleness.hpp"

namespace nodmap::navigator {

std::optional<Reason> reason_by_staleness(const InputStamps& stamps, const StalenessParams& limits,
                                          bool needs_scans) {
  if (!stamps.odometry) {
    return Reason(Why::kNoInput, "odometry");
  }
  struct Input {
    const char* name = nullptr;
    std::optional<time::Timestamp> stamp;
    double limit_s = 0.0;
    bool is_needed = true;
  };
  for (const Input& input :
       {Input{"obstacle map", stamps.map, limits.map_s},
        Input{"scan for the local map", stamps.scan, limits.map_s, needs_scans},
        Input{"speed bound of the pitch controller", stamps.pitch_command, limits.pitch_command_s},
        Input{"reading of the pitch servo", stamps.pitch_state, limits.pitch_state_s}}) {
    if (!input.is_needed) {
      continue;
    }
    if (!input.stamp) {
      return Reason(Why::kNoInput, input.name);
    }
    const double age_s = time::seconds(*stamps.odometry - *input.stamp);
    if (age_s > input.limit_s) {
      return Reason(Why::kStaleInput, input.name);
    }
    if (age_s < -limits.odometry_s) {
      return Reason(Why::kFutureInput, input.name);
    }
  }
  return std::nullopt;
}

}  // namespace nodmap::navigator
