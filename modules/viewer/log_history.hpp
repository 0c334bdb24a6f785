// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/geometry/time.hpp"
#include "common/node/status.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"

namespace nodmap::viewer {

using foxglove::Json;

/// Longest time between messages without a gap in a plot. STATUS, once a second, has the longest
/// period.
inline constexpr double kGapS = 1.0;
inline constexpr double kStatusGapS = time::seconds(node::kStatusSilence);

/// One quantity over a whole recording, with as many samples as a plot can show: the smallest and
/// the greatest value of each interval, with their times.
class Series {
 public:
  /// `gap_s`: values farther apart have a gap between them.
  Series(double interval_s, double gap_s) : interval_s_(interval_s), gap_s_(gap_s) {}

  /// Adds a value; ignores one that is not finite. `time_s` must not decrease.
  void add(double time_s, double value);

  /// All samples, [time_s, value]; the value is null where a gap begins.
  [[nodiscard]] Json samples() const;

 private:
  struct Sample {
    double time_s = 0.0;
    double value = 0.0;
  };
  [[nodiscard]] std::vector<Sample> open_samples() const;
  void close_interval();

  double interval_s_;
  double gap_s_;
  std::vector<Sample> samples_;  // of the completed intervals; NaN where a gap begins
  // Of the present interval; empty if it has no values.
  std::vector<Sample> extremes_;  // smallest, greatest
  double interval_end_s_ = 0.0;
  double last_s_ = 0.0;
};

/// The quantities that the page plots, over whole recordings: `forward_mps`, `max_forward_mps`,
/// `clear_distance_m`, `nearest_m` (the nearest point of OBSTACLE_MAP), `pitch_rad`, `sweep_s`, and
/// `latency_p99_us PROCESS`. Times are those of bus::LogPlayer, in seconds since the epoch.
/// Throws as it does.
[[nodiscard]] Json log_history(const std::vector<std::filesystem::path>& logs);

}  // namespace nodmap::viewer
