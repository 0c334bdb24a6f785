// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace nodmap::navigator {

/// The directions that the nodding laser has had in view for long enough to know what is there. An
/// obstacle map without a point in a direction does not tell "free" from "not seen yet"; this does,
/// and the robot does not drive to directions it has not seen.
///
/// Kept by compass direction in odom: while the robot drives on, what is ahead stays in view; a
/// rotation brings new directions into view, and those that leave it are forgotten. While no scans
/// come sweeps end without a look: after a long gap all is forgotten, after one shorter than a
/// sweep what had not been seen before (Navigator::respect_gap() says why that is safe).
class SeenDirections {
 public:
  /// `view_half_rad`: directions up to so far from ahead are in view.
  explicit SeenDirections(double view_half_rad) : view_half_rad_(view_half_rad) {}

  /// The heading in odom and the number of sweeps at this moment.
  void update(double heading_rad, std::int64_t sweep_count);

  /// Whether the direction (in base, positive left) has been in view while at least `sweeps` sweeps
  /// ended: with two, it was seen at every pitch between both ends.
  [[nodiscard]] bool is_seen(double direction_rad, int sweeps) const;

  void forget() { in_view_since_.fill(std::nullopt); }

  /// Of a gap in the scans: what was in view for fewer sweeps before it has not been seen.
  void forget_unseen(int sweeps);

 private:
  static constexpr int kBins = 360;  // a degree each

  double view_half_rad_;
  double heading_rad_ = 0.0;
  std::int64_t sweep_count_ = 0;
  std::array<std::optional<std::int64_t>, kBins> in_view_since_;
};

}  // namespace nodmap::navigator
