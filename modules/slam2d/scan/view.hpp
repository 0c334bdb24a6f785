// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "common/geometry/se2.hpp"

namespace nodmap::slam2d {

/// What one level scan shows: its points and, for each direction from the sensor, how far space was
/// free.
class View {
 public:
  /// Fewer points may belong to a thin object, or to an edge, that the beams of another view
  /// missed.
  static constexpr std::size_t kMinPoints = 3;

  View(std::vector<Eigen::Vector2d> points_base, const Eigen::Vector2d& sensor_origin_base);

  /// Whether the view shows free space as far as `p_base` and 0.3 m beyond.
  [[nodiscard]] bool saw_free(const Eigen::Vector2d& p_base) const;

  /// Whether this view and another cannot both be right: more than a quarter of the comparable
  /// points of one lie where the other saw free space. `T_this_other`: base of the other in base of
  /// this one. Views that show nothing in common contradict nothing.
  [[nodiscard]] bool contradicts(const View& other, const geometry::SE2& T_this_other) const;

 private:
  static constexpr std::size_t kNumBins = 360;

  [[nodiscard]] bool saw_through(const View& other, const geometry::SE2& T_this_other) const;

  Eigen::Vector2d sensor_origin_base_;
  std::vector<Eigen::Vector2d> points_base_;
  std::array<double, kNumBins> free_m_{};  ///< from the sensor origin; 0: not known
  double farthest_free_m_ = 0.0;
};

}  // namespace nodmap::slam2d
