// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "modules/slam2d/correlative_matcher.hpp"
#include "modules/slam2d/known_map.hpp"
#include "modules/slam2d/level_scan.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/scan_matcher.hpp"

namespace nodmap::slam2d {

/// Where in a map a scan was taken, if that can be told.
struct Relocalisation {
  enum class Status : std::uint8_t {
    kFound,
    kNowhere,    ///< the scan fits nowhere in the map
    kAmbiguous,  ///< it fits several places
  };

  Status status = Status::kNowhere;
  geometry::SE2 T_map_base;  ///< of the best place, whatever the status; not valid for kNowhere
  double score = 0.0;        ///< of the best place, 0..1
  double runner_up_score = 0.0;
};

/// The points of the last few level scans, placed by odometry: more is seen from several places.
class RecentScans {
 public:
  explicit RecentScans(std::size_t num_scans) : num_scans_(num_scans) {}

  void add(const LevelScan& scan);
  void clear() { scans_.clear(); }
  [[nodiscard]] std::size_t size() const { return scans_.size(); }
  /// All points, in base at the last scan.
  [[nodiscard]] std::vector<OrientedPoint> points_base() const;

 private:
  struct PlacedScan {
    geometry::SE2 T_odom_base;
    std::vector<OrientedPoint> points_base;
  };
  std::size_t num_scans_;
  std::deque<PlacedScan> scans_;
};

/// Finds the robot in a known map from nothing: the best poses of all in the map by branch and
/// bound, each matched exactly and checked for walls that its rays pass through. The best is
/// believed only when it fits clearly better than any other place.
class Relocaliser {
 public:
  Relocaliser(const RelocaliserParams& params, const MatcherParams& matcher);

  /// `scan`: points in base, of one scan or of several successive ones.
  [[nodiscard]] Relocalisation locate(const KnownMap& map, std::span<const OrientedPoint> scan,
                                      const Eigen::Vector2d& sensor_origin_base) const;

 private:
  RelocaliserParams params_;
  CorrelativeMatcher correlative_;
  ScanMatcher matcher_;
};

}  // namespace nodmap::slam2d
