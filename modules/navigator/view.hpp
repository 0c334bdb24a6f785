// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace nodmap::navigator {

/// Which directions the nodding laser has had in view for long enough to know what is there. An
/// obstacle map without a point in a direction does not tell "free" from "never looked there"; this
/// does, and what was not looked at is not driven to.
///
/// Kept by compass direction in odom: driving on, what is ahead stays in view; turning brings new
/// directions in, and those that leave the view are forgotten.
class View {
 public:
  explicit View(double half_rad) : half_rad_(half_rad) {}

  /// The robot's heading in odom, and the count of the nod's turns, at this moment.
  void look(double heading_rad, std::int64_t sweep_count);

  /// Whether the direction (in base, positive left) has been in view while the nod turned round at
  /// least `half_sweeps` times: with two, it was seen at every pitch between both ends.
  [[nodiscard]] bool trusts(double direction_rad, int half_sweeps) const;

  void forget() { in_view_since_.fill(std::nullopt); }

 private:
  static constexpr int kBins = 360;  // a degree each

  double half_rad_;
  double heading_rad_ = 0.0;
  std::int64_t sweep_count_ = 0;
  std::array<std::optional<std::int64_t>, kBins> in_view_since_;
};

}  // namespace nodmap::navigator
