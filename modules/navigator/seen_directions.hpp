// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

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
  /// `view_half_rad`: directions up to this angle from ahead are in view.
  explicit SeenDirections(double view_half_rad) : view_half_rad_(view_half_rad) {}

  /// Updates the heading in odom and the number of sweeps.
  void update(double heading_rad, std::int64_t sweep_count);

  /// Whether a direction (in base, positive left) has been in view while at least `sweeps` sweeps
  /// ended. With two, it was seen at every pitch from one reversal to the other.
  [[nodiscard]] bool is_seen(double direction_rad, int sweeps) const;

  void forget() { in_view_since_.fill(std::nullopt); }

  /// For a gap in the scans: forgets the directions that had been in view for fewer than `sweeps`
  /// sweeps.
  void forget_unseen(int sweeps);

 private:
  static constexpr int kBins = 360;  // a degree each

  double view_half_rad_;
  double heading_rad_ = 0.0;
  std::int64_t sweep_count_ = 0;
  std::array<std::optional<std::int64_t>, kBins> in_view_since_;
};

}  // namespace nodmap::navigator
