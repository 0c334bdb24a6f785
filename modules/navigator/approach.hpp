// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "modules/navigator/obstacle_points.hpp"
#include "modules/navigator/view.hpp"

namespace nodmap::navigator {

/// Notices that something comes nearer to the robot while it stands or turns on the spot. People
/// walk at 1 m/s and more, and corners that turn meet them: who comes near is given way to.
///
/// Kept by compass direction, like the view: what is in view for the first time only came into
/// view, and turning on the spot changes no distance.
class Approach {
 public:
  /// `reach_m`: what stays farther from the base's origin does not matter.
  Approach(double reach_m, int half_sweeps_to_trust)
      : reach_m_(reach_m), half_sweeps_(half_sweeps_to_trust) {}

  /// The obstacles of this moment; `view` has looked at the same.
  void look(std::int64_t utime_us, double heading_rad, const Points& points_base, const View& view);

  /// Whether something has come nearer within the last second: it may be coming still, and the
  /// laser looks at it about so often.
  [[nodiscard]] bool is_close(std::int64_t utime_us) const;

  /// The robot drives: everything comes nearer.
  void forget();

 private:
  static constexpr int kSectors = 36;
  using Sectors = std::array<double, kSectors>;

  [[nodiscard]] static Sectors nearest(double heading_rad, const Points& points_base);

  double reach_m_;
  int half_sweeps_;
  std::optional<Sectors> known_m_;  // distance of the nearest point, by compass sector
  std::optional<std::int64_t> came_us_;
};

}  // namespace nodmap::navigator
