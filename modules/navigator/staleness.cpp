// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/staleness.hpp"

namespace nodmap::navigator {
namespace {

double seconds(std::int64_t us) {
  return 1e-6 * static_cast<double>(us);
}

}  // namespace

std::optional<std::string> reason_to_halt(const InputStamps& stamps, const StalenessParams& limits,
                                          bool needs_scans) {
  if (!stamps.odometry_us) {
    return "There is no odometry.";
  }
  struct Input {
    const char* name = nullptr;
    std::optional<std::int64_t> utime_us;
    double limit_s = 0.0;
    bool is_needed = true;
  };
  for (const Input& input :
       {Input{"obstacle map", stamps.map_us, limits.map_s},
        Input{"scan for the local map", stamps.scan_us, limits.map_s, needs_scans},
        Input{"speed bound of the pitch controller", stamps.pitch_command_us,
              limits.pitch_command_s},
        Input{"reading of the pitch servo", stamps.pitch_state_us, limits.pitch_state_s}}) {
    if (!input.is_needed) {
      continue;
    }
    if (!input.utime_us) {
      return std::string("There is no ") + input.name + ".";
    }
    const double age_s = seconds(*stamps.odometry_us - *input.utime_us);
    if (age_s > input.limit_s) {
      return std::string("The ") + input.name + " is stale.";
    }
    if (age_s < -limits.odometry_s) {
      return std::string("Odometry is stale, or the ") + input.name + " is from the future.";
    }
  }
  return std::nullopt;
}

}  // namespace nodmap::navigator
