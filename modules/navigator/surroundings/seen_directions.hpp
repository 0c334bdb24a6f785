// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "modules/navigator/params.hpp"

namespace nodmap::navigator {

/// The directions that the nodding laser has had in view long enough to know what is there. In an
/// obstacle map a direction without a point may be free or not seen yet. This tells the two apart:
/// the robot does not drive in directions that it has not seen.
///
/// Directions are kept in odom. While the robot drives straight, what is ahead stays in view; a
/// rotation brings new directions into view, and those that leave it are forgotten. A gap in the
/// scans hides the sweeps that end in it. After a long gap everything is forgotten; after one
/// shorter than a sweep only what had not been seen before it (scan_gap.hpp says why that is safe).
class SeenDirections {
 public:
  explicit SeenDirections(const SteerParams& params)
      : view_half_rad_(params.view_half_rad), sweeps_to_trust_(params.sweeps_to_trust) {}

  /// Updates the heading in odom and the number of sweeps.
  void update(double heading_rad, std::int64_t sweep_count);

  /// Whether a direction (in base, positive left) has been in view while `sweeps_to_trust` sweeps
  /// ended. With two, it was seen at every pitch from one reversal to the other.
  [[nodiscard]] bool is_seen(double direction_rad) const;
  [[nodiscard]] bool is_in_view(double direction_rad) const;

  void forget() { in_view_since_.fill(std::nullopt); }

  /// For a gap in the scans: forgets the directions that had not been seen before it.
  void forget_unseen();

 private:
  static constexpr int kBins = 360;  // a degree each

  using SweepCount = std::optional<std::int64_t>;

  [[nodiscard]] SweepCount in_view_since(double direction_rad) const;
  [[nodiscard]] bool is_seen_since(const SweepCount& since) const;

  double view_half_rad_;
  int sweeps_to_trust_;
  double heading_rad_ = 0.0;
  std::int64_t sweep_count_ = 0;
  std::array<SweepCount, kBins> in_view_since_;
};

}  // namespace nodmap::navigator
