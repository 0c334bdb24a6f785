// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/navigator/rolling_grid.hpp"

namespace nodmap::navigator {

/// The space around the robot that beams have passed through in several scans: whatever is measured
/// there now has moved there (the ever-free space of Dynablox, Schmid et al., RA-L 2023). Stored as
/// columns of 10 cm x 10 cm with layers of 10 cm, in a square in odom that follows the robot.
///
/// A place is free only if the layers below and above it and the columns around it are free as
/// well, because beams pass over a low box before they hit it, and under a table.
class EverFree {
 public:
  /// Range of heights for which is_free() answers: shins and thighs.
  static constexpr double kLowestM = 0.2;
  static constexpr double kHighestM = 0.5;

  /// `range_m`: the largest distance for which is_free() is called. Places farther away are
  /// forgotten, before odometry has drifted.
  explicit EverFree(double range_m = 0.0);

  /// Begins a scan, made at `stamp` from about `T_odom_base`.
  void begin_scan(time::Timestamp stamp, const geometry::SE2& T_odom_base);

  /// A beam of this scan has ended at a place. All hits of a scan are added before its passes.
  void hit(const Eigen::Vector2d& p_odom, double height_m);

  /// A beam of this scan has passed from one place to another; heights in metres.
  void pass(const Eigen::Vector2d& from_odom, double from_height_m, const Eigen::Vector2d& to_odom,
            double to_height_m);

  /// Whether a place between kLowestM and kHighestM was free before. `laser_is_held`: the laser
  /// does not nod. It sees only one layer, so the other layers do not count, and with each scan all
  /// that is in view, so what it has not seen free lately was hidden. What comes into view there
  /// may have been there all the time, beside where odometry remembers it.
  [[nodiscard]] bool is_free(const Eigen::Vector2d& p_odom, double height_m,
                             bool laser_is_held = false) const;

  /// Whether a beam of this scan has passed there between kLowestM and kHighestM.
  [[nodiscard]] bool is_passed_now(const Eigen::Vector2d& p_odom) const;

 private:
  static constexpr int kLayers = 5;  // one below kLowestM, one above kHighestM
  struct Column {
    std::array<std::uint8_t, kLayers> free{};  ///< scans with a pass minus scans with a hit
    std::uint32_t changed = 0;                 ///< the scan of the last change
    std::uint32_t passed = 0;                  ///< the scan of the last pass
    time::Timestamp passed_at{};               ///< its stamp
    float passed_at_m = 0.0F;                  ///< what the robot had travelled by then
  };

  [[nodiscard]] static int layer_of(double height_m);
  /// In all of these layers.
  [[nodiscard]] bool is_free(const Eigen::Vector2i& index, int lowest, int highest) const;
  [[nodiscard]] bool was_in_view(const Eigen::Vector2i& index) const;

  RollingGrid<Column> grid_;
  std::uint32_t scan_ = 0;
  time::Timestamp stamp_{};
  geometry::SE2 T_odom_base_;
  double travelled_m_ = 0.0;  // since the first scan, see travel_m()
};

}  // namespace nodmap::navigator
