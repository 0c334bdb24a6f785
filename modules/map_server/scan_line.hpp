// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "common/scan/scan.hpp"

namespace nodmap::map_server {

/// A plane that is not vertical, as a height above each point (x, y) of base.
struct SlantedPlane {
  double offset_m = 0.0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();

  [[nodiscard]] double height_m(const Eigen::Vector2d& p) const { return offset_m + slope.dot(p); }
};

/// The plane of the beams at a pitch, in base; empty if the plane is almost vertical.
[[nodiscard]] std::optional<SlantedPlane> laser_plane(const scan::Scan& scan, double pitch_rad);

/// The beams of one scan as a line over the ground. Finds, for a point p_base on the ground, the
/// height at which the beams cross it, and whether they end there or reach beyond.
class ScanLine {
 public:
  /// Where the scan crosses a point on the ground: between which beams, and at which height.
  struct Crossing {
    std::size_t beam = 0;   ///< the point is between this beam
    std::size_t next = 0;   ///< and this one: the first again after the last beam of a full circle
    double between = 0.0;   ///< fraction: 0 on `beam`, 1 on `next`
    double range_m = 0.0;   ///< from the mirror to the point, in the laser plane
    double height_m = 0.0;  ///< of the laser plane above the point, in base
  };

  /// Keeps a reference to `scan`, which must outlive this object.
  explicit ScanLine(const scan::Scan& scan);

  /// The crossing at a point on the ground; empty outside the scan's field of view.
  [[nodiscard]] std::optional<Crossing> crossing_at(const Eigen::Vector2d& p_base) const;

  /// The range measured in the direction of the crossing: interpolated if both beams hit the same
  /// surface, else the reading of the nearer beam; empty if that beam has no reading.
  [[nodiscard]] std::optional<double> measured_range_m(const Crossing& crossing) const;

  /// Whether the beams on BOTH sides reach farther than `range_m`. One beam alone proves nothing:
  /// it may graze the wall that the point belongs to.
  [[nodiscard]] bool both_reach_beyond(const Crossing& crossing, double range_m) const {
    return reaches_beyond(crossing.beam, range_m) && reaches_beyond(crossing.next, range_m);
  }

  /// Whether one of the two beams ends before the point and the other reaches beyond it.
  [[nodiscard]] bool ends_on_either_side(const Crossing& crossing) const {
    return scan_->is_hit(crossing.beam) && scan_->is_hit(crossing.next) &&
           reaches_beyond(crossing.beam, crossing.range_m) !=
               reaches_beyond(crossing.next, crossing.range_m);
  }

 private:
  [[nodiscard]] bool reaches_beyond(std::size_t beam, double range_m) const;

  const scan::Scan* scan_;
  Eigen::Vector3d sensor_origin_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d forward_ = Eigen::Vector3d::UnitX();  // axes of the laser frame in base
  Eigen::Vector3d left_ = Eigen::Vector3d::UnitY();
  std::optional<SlantedPlane> first_plane_;  // at the pitch of the first beam,
  std::optional<SlantedPlane> last_plane_;   // and of the last: the pitch changes during a scan
  double beams_per_rad_ = 0.0;
  double last_beam_ = 0.0;
  bool closes_the_circle_ = false;  // one step after the last beam is the first one
};

}  // namespace nodmap::map_server
