// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "modules/map_server/angle_bins.hpp"

namespace nodmap::map_server {

/// Which of two points in one direction a map keeps.
enum class Relevance { kNearest, kFarthest };

/// Where beams have passed through a point since it was last measured.
struct Search {
  double lowest_m = std::numeric_limits<double>::infinity();  ///< heights at which they passed
  double highest_m = -std::numeric_limits<double>::infinity();
  std::int64_t last_missed_sweep = -1;
  int missed_sweeps = 0;
};

/// A point of an egocentric map, cartesian and polar at once (III B), in the base frame.
struct EgoPoint {
  Eigen::Vector2d p_base = Eigen::Vector2d::Zero();
  double bearing_rad = 0.0;  ///< atan2(y, x): as seen from the base, not the mirror's angle
  double distance_m = 0.0;   ///< hypot(x, y)

  double height_m = 0.0;  ///< above the ground, of the measurement the point stands for
  double lowest_m = 0.0;  ///< heights at which something was measured here
  double highest_m = 0.0;

  double confirmed_at_s = 0.0;       ///< when last measured, on the map's clock
  double aged_s = 0.0;               ///< towards expiry, as the update rule counts
  std::int64_t confirmed_sweep = 0;  ///< in which it was last measured
  Search search;                     ///< used by the visibility rule only
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

/// The paper's extension of a laser scan (III B): a vector of points, indexed by the discretised
/// angle at which the base sees them. A direction without a point holds a dummy, whose distance
/// loses against any measurement: +infinity where the nearest counts, -infinity where the farthest.
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

  /// The replacement test of III B, <= for the nearest and >= for the farthest.
  [[nodiscard]] bool prefers(double distance_m, double stored_distance_m) const {
    return relevance_ == Relevance::kNearest ? distance_m <= stored_distance_m
                                             : distance_m >= stored_distance_m;
  }

  void clear() { points_.assign(points_.size(), dummy_); }

  /// Step 1, Eq. 2: transforms every point into the present base frame. Of two points in one bin
  /// the more relevant stays; bins left empty get dummies; points outside the aperture are dropped.
  ///
  /// The paper's angles are positive clockwise in a left-handed frame, so the matrix printed in
  /// Eq. 2 is the inverse of the robot's own rotation, and its (dx, dz) is the shift of the map,
  /// not of the robot. In one line: p_now = T_now_last * p_last.
  void transform(const geometry::SE2& T_now_last);

 private:
  AngleBins bins_;
  Relevance relevance_;
  EgoPoint dummy_;
  std::vector<EgoPoint> points_;
  std::vector<EgoPoint> moved_;  // the other half of a double buffer: no allocation per scan
};

}  // namespace nodmap::map_server
