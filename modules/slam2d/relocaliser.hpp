// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "modules/slam2d/best_place.hpp"
#include "modules/slam2d/correlative_matcher.hpp"
#include "modules/slam2d/known_map.hpp"
#include "modules/slam2d/level_scan.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/scan_matcher.hpp"

namespace nodmap::slam2d {

/// The place in a map where a scan was taken, if it is unambiguous.
struct Relocalisation {
  enum class Status : std::uint8_t {
    kFound,
    kNowhere,    ///< the scan fits nowhere in the map
    kAmbiguous,  ///< it fits several places
  };

  Status status = Status::kNowhere;
  geometry::SE2 T_map_base;  ///< of the best place, whatever the status; not valid for kNowhere
  double score = 0.0;        ///< of the best place: how much of the scan lies on walls, 0..1
  double runner_up_score = 0.0;
};

/// Finds the robot in a known map without a start pose: the best of all poses by branch and bound,
/// each matched exactly. The best match is believed only when more of the scan lies on the walls of
/// the map there, and less was measured through walls, than at any other place.
class Relocaliser {
 public:
  Relocaliser(const RelocaliserParams& params, const MatcherParams& matcher);

  /// Locates a single scan.
  [[nodiscard]] Relocalisation locate(const KnownMap& map, const LevelScan& scan) const;

  /// Locates a single scan that was taken in this part of the map.
  [[nodiscard]] Relocalisation locate(const KnownMap& map, const SearchWindow& window,
                                      const LevelScan& scan) const;

  /// Locates the last of one or more successive scans. Each is placed on its own, and each place,
  /// moved by odometry, is tried for the others, too. Together the scans distinguish places that
  /// look alike to a single scan. A place that one of them contradicts is not believed.
  [[nodiscard]] Relocalisation locate(const KnownMap& map, std::span<const LevelScan> scans) const;

 private:
  /// A pose at which a scan was matched.
  struct Place {
    geometry::SE2 T_map_base;
    double match_score = 0.0;  ///< less the part measured through walls; tells the best place
    double wall_score = 0.0;   ///< tells how clear it is: noise in the map hardly changes it
    Eigen::Vector2d least_determined = Eigen::Vector2d::UnitX();  ///< direction, by the match
  };
  /// Where one scan fits.
  struct Places {
    std::vector<Place> places;
    bool is_complete = true;  ///< false: it may fit elsewhere, too
    Relocalisation alone;     ///< the result of this scan alone
  };
  /// How one scan fits a place.
  struct ScanFit {
    std::optional<Place> match;  ///< as the scan matches near there, if it does
    bool agrees = false;         ///< it fits there, and is not sure of another place
    bool is_sure = false;        ///< it alone tells that this is the place
  };
  /// How all scans together fit a place of the last one.
  struct JointFit {
    Place place;           ///< as the last scan matches there; the mean scores of all
    bool agrees = true;    ///< each scan fits there, and none is sure of another place
    bool is_sure = false;  ///< one scan alone tells that this is the place
  };
  /// Whether two places are the same, apart from errors of odometry.
  [[nodiscard]] bool agree(const geometry::SE2& a, const geometry::SE2& b) const;
  /// The best of some places that agree with a pose.
  [[nodiscard]] std::optional<Place> best_near(std::span<const Place> places,
                                               const geometry::SE2& T_map_guess) const;
  [[nodiscard]] Places find_places(const KnownMap& map, const SearchWindow& window,
                                   const LevelScan& scan) const;
  [[nodiscard]] std::optional<Place> match(const KnownMap& map, const LevelScan& scan,
                                           const geometry::SE2& T_map_base) const;
  /// The index of the best of some places, which must not be empty.
  [[nodiscard]] static std::size_t best_of(std::span<const Place> places);
  /// How well the scans fit a few decimetres from a place of the last scan.
  [[nodiscard]] static double score_beside(const KnownMap& map, std::span<const LevelScan> scans,
                                           const Place& place);
  /// How well the scans fit the best place and elsewhere. `places`: of the last scan, not empty.
  [[nodiscard]] static BestPlace compare(const KnownMap& map, std::span<const LevelScan> scans,
                                         std::span<const Place> places);
  [[nodiscard]] Relocalisation classify(const KnownMap& map, std::span<const LevelScan> scans,
                                        std::span<const Place> places, bool is_complete) const;
  [[nodiscard]] Relocalisation join(const KnownMap& map, std::span<const LevelScan> scans,
                                    std::span<const Places> found) const;
  [[nodiscard]] ScanFit fit(const KnownMap& map, const LevelScan& scan, const Places& found,
                            const geometry::SE2& T_map_base) const;
  [[nodiscard]] JointFit fit(const KnownMap& map, std::span<const LevelScan> scans,
                             std::span<const Places> found, const geometry::SE2& T_map_last) const;

  RelocaliserParams params_;
  CorrelativeMatcher correlative_;
  ScanMatcher matcher_;
};

}  // namespace nodmap::slam2d
