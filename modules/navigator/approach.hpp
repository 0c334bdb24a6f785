// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/geometry/se2.hpp"
#include "modules/navigator/obstacle_points.hpp"
#include "modules/navigator/view.hpp"

namespace nodmap::navigator {

/// Notices that something comes nearer by itself, whatever the robot does. People walk at 1 m/s and
/// more, and give way to nobody: who comes near is given way to.
///
/// Looks from a place in odom that stays while the robot moves on a little, so that what only the
/// robot comes nearer to is no approach. Kept by direction from there: what is in view for the
/// first time only came into view, and what was hidden from there behind something else is farther
/// than that.
class Approach {
 public:
  explicit Approach(int half_sweeps_to_trust) : half_sweeps_(half_sweeps_to_trust) {}

  /// The obstacles of this moment; `view` has looked at the same. What stays farther than `reach_m`
  /// from the base's origin does not matter.
  void look(std::int64_t utime_us, const geometry::SE2& T_odom_base, double reach_m,
            const Points& points_base, const View& view);

  /// Whether something has come nearer within the last second: it may be coming still, and the
  /// laser looks at it about so often.
  [[nodiscard]] bool is_close(std::int64_t utime_us) const;

 private:
  static constexpr int kSectors = 36;
  /// The nearest point of a direction as seen from the place.
  struct Nearest {
    double distance_m = 0.0;
    Eigen::Vector2d p_base;
  };
  using Sectors = std::array<Nearest, kSectors>;

  [[nodiscard]] Sectors nearest(const geometry::SE2& T_odom_base, const Points& points_base) const;
  void compare(const Sectors& now, std::int64_t utime_us, double reach_m, const View& view);

  int half_sweeps_;
  Eigen::Vector2d place_odom_ = Eigen::Vector2d::Zero();
  std::optional<Sectors> known_;
  std::optional<std::int64_t> came_us_;
};

}  // namespace nodmap::navigator
