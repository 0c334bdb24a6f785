// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/scan/scan.hpp"

namespace nodmap::slam2d {

/// A measured point on a wall or an object, with its normal. In metres; the variable's name says in
/// which frame.
struct OrientedPoint {
  Eigen::Vector2d p = Eigen::Vector2d::Zero();
  /// Unit normal, towards the scanner; zero where it is not known.
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();

  [[nodiscard]] bool has_normal() const { return !normal.isZero(0.0); }
};

/// Transforms points from frame b to frame a.
[[nodiscard]] std::vector<OrientedPoint> transformed(const geometry::SE2& T_a_b,
                                                     std::span<const OrientedPoint> points_b);

/// Extracts the data set D of Eq. 3 from a level scan: its points deskewed and projected onto the
/// floor, in base, each with its normal. Does not allocate while the number of beams stays the
/// same.
class OrientedPointExtractor {
 public:
  /// Returns the points of all beams that hit something, in beam order, valid until the next call.
  /// `T_first_last`: the motion of base from the first beam to the last. The points are where a
  /// robot that stays at its pose at the first beam would have measured them.
  [[nodiscard]] std::span<const OrientedPoint> extract(const scan::Scan& scan,
                                                       const geometry::SE2& T_first_last);

  /// The same for points that were measured at once, in the order of their directions from
  /// `sensor_origin_base`.
  [[nodiscard]] std::span<const OrientedPoint> extract(std::span<const Eigen::Vector2d> points_base,
                                                       const Eigen::Vector2d& sensor_origin_base);

 private:
  scan::ScanProjector projector_;
  std::vector<Eigen::Vector2d> positions_;
  std::vector<OrientedPoint> points_;
};

/// Estimates the unit normal at `points[index]`, towards `sensor_origin`, from a line through its
/// neighbours in the scan, up to 0.3 m away. Returns zero if there are fewer than two.
[[nodiscard]] Eigen::Vector2d estimate_normal(std::span<const Eigen::Vector2d> points,
                                              std::size_t index,
                                              const Eigen::Vector2d& sensor_origin);

}  // namespace nodmap::slam2d
