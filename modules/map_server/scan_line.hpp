// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "common/scan/scan.hpp"

namespace nodmap::map_server {

/// A plane that is not vertical: z as a function of the place on the ground.
struct SlantedPlane {
  double offset_m = 0.0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();

  [[nodiscard]] double height_m(const Eigen::Vector2d& p) const { return offset_m + slope.dot(p); }
};

/// The plane of the beams at a pitch, in the base frame; empty where it is so near to vertical that
/// it has no height over a place on the ground.
[[nodiscard]] std::optional<SlantedPlane> laser_plane(const scan::Scan& scan, double pitch_rad);

/// One scan seen from a place on the ground: at which height the beams cross that place, and
/// whether they end there or reach beyond.
class ScanLine {
 public:
  /// The beams on either side of a place, and how they cross it.
  struct Crossing {
    std::size_t beam = 0;   ///< the place lies between this beam and the next
    double between = 0.0;   ///< 0 on this beam, 1 on the next
    double range_m = 0.0;   ///< from the mirror to the place, in the laser plane
    double height_m = 0.0;  ///< of the laser plane over the place, base frame
  };

  /// Refers to the scan, which must outlive the line.
  explicit ScanLine(const scan::Scan& scan);

  /// Empty outside the fan.
  [[nodiscard]] std::optional<Crossing> crossing_at(const Eigen::Vector2d& p_base) const;

  /// The range measured towards the place: interpolated where both beams hit one surface, else the
  /// reading of the beam next to it; empty where that beam has none.
  [[nodiscard]] std::optional<double> measured_range_m(const Crossing& crossing) const;

  /// Whether the beams on BOTH sides reach farther than `range_m`. One alone is no proof: it may
  /// graze a wall that the place belongs to.
  [[nodiscard]] bool both_reach_beyond(const Crossing& crossing, double range_m) const {
    return reaches_beyond(crossing.beam, range_m) && reaches_beyond(crossing.beam + 1, range_m);
  }

  /// Whether of the two beams one ends before the place and one reaches beyond.
  [[nodiscard]] bool ends_on_either_side(const Crossing& crossing) const {
    return scan_->is_hit(crossing.beam) && scan_->is_hit(crossing.beam + 1) &&
           reaches_beyond(crossing.beam, crossing.range_m) !=
               reaches_beyond(crossing.beam + 1, crossing.range_m);
  }

 private:
  [[nodiscard]] bool reaches_beyond(std::size_t beam, double range_m) const;

  const scan::Scan* scan_;
  Eigen::Vector3d sensor_origin_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d forward_ = Eigen::Vector3d::UnitX();  // axes of the laser frame in base
  Eigen::Vector3d left_ = Eigen::Vector3d::UnitY();
  std::optional<SlantedPlane> first_plane_;  // the pitch moves during a scan
  std::optional<SlantedPlane> last_plane_;
  double beams_per_rad_ = 0.0;
  double last_beam_ = 0.0;
};

}  // namespace nodmap::map_server
