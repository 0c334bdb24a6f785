// SPDX-License-Identifier: BSD-3-Clause
// 3DTK's uos format: scanNNN.3d (points) and scanNNN.pose. Its frame is left-handed, x right, y up,
// z ahead, in centimetres; it is converted to our frame here and nowhere else.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"

namespace nodmap::convert {

/// A point or vector of the file (cm) in metres, x forward, y left, z up.
[[nodiscard]] Eigen::Vector3d from_uos(const Eigen::Vector3d& p_uos_cm);

/// A .pose file's position (cm) and Euler angles (degrees), converted as 3DTK does.
[[nodiscard]] geometry::SE3 from_uos_pose(const Eigen::Vector3d& position_cm,
                                          const Eigen::Vector3d& euler_deg);

/// The inverse: a point or vector in metres as one of the file, cm.
[[nodiscard]] Eigen::Vector3d to_uos(const Eigen::Vector3d& p_m);

/// The content of a .pose file.
struct UosPose {
  Eigen::Vector3d position_cm = Eigen::Vector3d::Zero();
  Eigen::Vector3d euler_deg = Eigen::Vector3d::Zero();
};
/// The inverse of from_uos_pose().
[[nodiscard]] UosPose to_uos_pose(const geometry::SE3& pose);

/// One mirror revolution: a plane through the scanner's left-right axis.
struct UosSlice {
  double pitch_rad = 0.0;  ///< positive looks up
  double angle_first_rad = 0.0;
  double angle_step_rad = 0.0;
  /// +infinity: no echo; NaN for beams missing in the file.
  std::vector<float> ranges_m;
  double range_max_m = 0.0;  ///< how far the scanner measures, as far as the points tell
};

/// Splits the points of a scan, in the order of the file, into slices: a new one begins where the
/// beam angle jumps back or the plane changes. All slices get the same fan, from the smallest to
/// the largest angle. In a scan of a SICK in indoor mode ranges from 32.76 m on mean "no echo"; if
/// any point is beyond the reach of that mode, all points are echoes. Empty if the points are not
/// such a scan.
[[nodiscard]] std::vector<UosSlice> find_slices(std::span<const Eigen::Vector3d> points_m);

}  // namespace nodmap::convert
