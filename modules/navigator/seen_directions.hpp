// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace nodmap::navigator {

/// The directions that the nodding laser has had in view long enough to know what is there. In an
/// obstacle map a direction without a point may be free or not seen yet. This distinguishes the
/// two, and the robot does not drive in directions that it has not seen.
///
/// Directions are kept in odom: while the robot drives straight, what is ahead stays in view; a
/// rotation brings new directions into view, and those that leave it are forgotten. In a gap in the
/// scans sweeps end without being seen: after a long gap everything is forgotten, after one shorter
/// than a sweep only directions that had not been seen before it (Navigator::respect_gap() explains
/// why that is safe).
class SeenDirections {
 public:
  /// `view_half_rad`: directions up to this angle from ahead are in view.
  explicit SeenDirections(double view_half_rad) : view_half_rad_(view_half_rad) {}

  /// Updates the heading in odom and the number of sweeps.
  void update(double heading_rad, std::int64_t sweep_count);

  /// Whether the direction (in base, positive left) has been in view while at least `sweeps` sweeps
  /// ended: with two, it was seen at every pitch between both ends.
  [[nodiscard]] bool is_seen(double direction_rad, int sweeps) const;

  void forget() { in_view_since_.fill(std::nullopt); }

  /// To be called after a gap in the scans: forgets directions that were in view for fewer sweeps
  /// before it.
  void forget_unseen(int sweeps);

 private:
  static constexpr int kBins = 360;  // a degree each

  double view_half_rad_;
  double heading_rad_ = 0.0;
  std::int64_t sweep_count_ = 0;
  std::array<std::optional<std::int64_t>, kBins> in_view_since_;
};

}  // namespace nodmap::navigator
