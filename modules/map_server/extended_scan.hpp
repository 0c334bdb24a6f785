// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/map_server/angle_bins.hpp"

namespace nodmap::map_server {

/// Which of two points in one direction a map keeps.
enum class Relevance : std::uint8_t { kNearest, kFarthest };

/// The beams that have passed through a point since it was last measured.
struct PassedBeams {
  double lowest_m = std::numeric_limits<double>::infinity();  ///< heights at which beams passed
  double highest_m = -std::numeric_limits<double>::infinity();
  std::int64_t last_missed_sweep = -1;
  int missed_sweeps = 0;
};

/// A point of an egocentric map, in base, with both cartesian and polar coordinates (III B).
struct EgoPoint {
  Eigen::Vector2d p_base = Eigen::Vector2d::Zero();
  double bearing_rad = 0.0;  ///< atan2(y, x) in base; not the beam's angle at the mirror
  double distance_m = 0.0;   ///< hypot(x, y)

  double height_m = 0.0;   ///< of the measurement stored here, above the ground
  double lowest_m = 0.0;   ///< lowest height at which this point was measured
  double highest_m = 0.0;  ///< highest height at which this point was measured

  double confirmed_at_s = 0.0;       ///< time of its last measurement, on the map server's clock
  double aged_s = 0.0;               ///< age that counts towards expiry, as the update rule defines
  std::int64_t confirmed_sweep = 0;  ///< sweep in which it was last measured
  PassedBeams passed;                ///< used by the visibility rule only
  bool valid = false;                ///< false: a dummy

  [[nodiscard]] static EgoPoint at(const Eigen::Vector2d& p_base, double height_m) {
    EgoPoint point;
    point.move_to(p_base);
    point.height_m = point.lowest_m = point.highest_m = height_m;
    point.valid = true;
    return point;
  }

  void move_to(const Eigen::Vector2d& p) {
    p_base = p;
    bearing_rad = std::atan2(p.y(), p.x());
    distance_m = p.norm();
  }
};

/// The paper's extended laser scan (III B): one point per angle bin, in the bin of its bearing in
/// base. A bin without a point contains a dummy, whose distance every measurement replaces:
/// +infinity if the map keeps the nearest points, -infinity if it keeps the farthest.
class ExtendedScan {
 public:
  ExtendedScan(const AngleBins& bins, Relevance relevance);

  [[nodiscard]] const AngleBins& bins() const { return bins_; }
  [[nodiscard]] Relevance relevance() const { return relevance_; }
  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] std::span<const EgoPoint> points() const { return points_; }
  [[nodiscard]] std::span<EgoPoint> points() { return points_; }
  [[nodiscard]] const EgoPoint& operator[](std::size_t bin) const { return points_[bin]; }
  [[nodiscard]] EgoPoint& operator[](std::size_t bin) { return points_[bin]; }
  [[nodiscard]] const EgoPoint& dummy() const { return dummy_; }

  /// Whether a point at `distance_m` replaces the stored one (III B): <= if the map keeps the
  /// nearest points, >= if it keeps the farthest.
  [[nodiscard]] bool prefers(double distance_m, double stored_distance_m) const {
    return relevance_ == Relevance::kNearest ? distance_m <= stored_distance_m
                                             : distance_m >= stored_distance_m;
  }

  void clear() { points_.assign(points_.size(), dummy_); }

  /// Step 1 (Eq. 2): transforms every point to the present base frame, p_now = T_now_last * p_last.
  /// If two points fall into one bin, the more relevant one is kept. Empty bins get dummies; points
  /// outside the aperture are dropped.
  ///
  /// The paper's angles are positive clockwise, in a left-handed frame. The matrix printed in Eq. 2
  /// is therefore the inverse of the robot's rotation, and its (dx, dz) is the shift of the map,
  /// not of the robot.
  void transform(const geometry::SE2& T_now_last);

 private:
  AngleBins bins_;
  Relevance relevance_;
  EgoPoint dummy_;
  std::vector<EgoPoint> points_;
  std::vector<EgoPoint> moved_;  // second buffer of transform(), kept to avoid allocations
};

}  // namespace nodmap::map_server
