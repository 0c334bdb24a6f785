// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "common/scan/scan.hpp"
#include "modules/navigator/obstacle_points.hpp"

namespace nodmap::navigator {

/// Detects in the scans that the wheels rotate but the robot does not move, because it pushes
/// against something that no beam shows, such as glass. SlipMonitor does the same with the poses of
/// 2D SLAM, which come seldom; a scan comes every 13 ms.
///
/// Compares a scan with earlier ones. Its points vote for "moved as odometry says" or for "stopped
/// on the way", at the place that explains most of them. A point votes if it lies where the earlier
/// scan has something by the one hypothesis and clearly not by the other. A wall along the motion
/// fits both and does not vote, so that in a bare corridor nothing is decided. While the head looks
/// down, little that is upright is in view: it takes half a nod longer.
///
/// Only scans of different pitch are compared. Then what is level, a floor or a ceiling, is met at
/// another range and fits neither: at the same pitch it is met at the same range wherever the robot
/// is. A plane that is neither level nor upright can fit the wrong one: not to be used near ramps.
class ScanSlip {
 public:
  /// `T_odom_base`: at the middle of the scan. If the wheels have rotated without moving the robot,
  /// returns base in odom before that; the comparison then begins anew.
  [[nodiscard]] std::optional<geometry::SE2> update(const scan::Scan& scan,
                                                    const geometry::SE2& T_odom_base);

  void reset() {
    views_.clear();
    scans_with_slip_ = 0;
  }

 private:
  /// What a scan shows that may be upright, by bearing.
  struct View {
    time::Timestamp stamp{};
    geometry::SE2 T_odom_base;
    double pitch_rad = 0.0;
    std::vector<double> bearings_rad;  ///< ascending
    std::vector<double> ranges_m;      ///< horizontal; 0: nothing upright
    Points points_base;                ///< what may be upright
  };
  using Views = std::deque<View>;
  struct Explanation {
    geometry::SE2 T_before_now;  ///< how base has moved
    int votes = 0;
  };
  enum class Evidence : std::uint8_t { kNone, kMoved, kSlipped };

  [[nodiscard]] View look(const scan::Scan& scan, const geometry::SE2& T_odom_base);
  [[nodiscard]] bool shows_slip(const View& now) const;

  template <class Holds>
  [[nodiscard]] static int count(const View& before, const geometry::SE2& T_before_now,
                                 const Points& points, const Holds& holds);
  [[nodiscard]] Explanation explain_by_slip(const Views::const_iterator& before, const View& now,
                                            const Points& points) const;
  [[nodiscard]] Evidence compare(const Views::const_iterator& before, const View& now) const;
  [[nodiscard]] static std::optional<double> behind_m(const View& before,
                                                      const Eigen::Vector2d& p_before);

  scan::ScanProjector projector_;
  Views views_;  // oldest first
  int scans_with_slip_ = 0;
};

}  // namespace nodmap::navigator
