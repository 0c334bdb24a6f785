// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/scan/scan.hpp"
#include "modules/slam2d/surface_point.hpp"

namespace nodmap::slam2d {

/// A level scan as the data set D of Eq. 3: its points seen from above in the base frame, each with
/// the normal of the line through its neighbours in the scan. Does not allocate while the sensor's
/// set-up stays the same.
class ScanSurface {
 public:
  /// The points of all beams that hit something, in beam order. Valid until the next call.
  /// `T_first_last`: how the robot moved (base) from the first beam to the last. It is stripped:
  /// the points are where a scanner at rest would have seen them at the time of the first beam.
  [[nodiscard]] std::span<const SurfacePoint> points(const scan::Scan& scan,
                                                     const geometry::SE2& T_first_last = {});

 private:
  scan::ScanProjector projector_;
  std::vector<Eigen::Vector2d> hits_;
  std::vector<SurfacePoint> points_;
};

/// The unit normal at `points[index]`, on the side of `eye`, from the points beside it that are
/// nearer than 0.3 m; zero where there are fewer than two.
[[nodiscard]] Eigen::Vector2d normal_at(std::span<const Eigen::Vector2d> points, std::size_t index,
                                        const Eigen::Vector2d& eye);

}  // namespace nodmap::slam2d
