// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "modules/slam2d/localise/known_map.hpp"
#include "modules/slam2d/matching/correlative_match.hpp"
#include "modules/slam2d/matching/scan_matcher.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/scan/level_scan.hpp"

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
  /// A pose at which a scan was matched.
  struct Candidate {
    geometry::SE2 T_map_base;
    double match_score = 0.0;  ///< less the part measured through walls; tells the best place
    double wall_score = 0.0;   ///< tells how clear it is: noise in the map hardly changes it
    Eigen::Vector2d least_determined = Eigen::Vector2d::UnitX();  ///< direction, by the match
  };
  /// Where a scan fits.
  struct Candidates {
    std::vector<Candidate> all = {};
    bool is_complete = true;  ///< false: it may fit elsewhere, too
  };
  /// The wall score if the scan was taken at T_map_base.
  using WallScore = std::function<double(const geometry::SE2&)>;

  Relocaliser(const RelocaliserParams& params, const MatcherParams& matcher);

  /// Locates a scan.
  [[nodiscard]] Relocalisation locate(const KnownMap& map, const LevelScan& scan) const;
  /// Locates a scan that was taken in this part of the map.
  [[nodiscard]] Relocalisation locate(const KnownMap& map, const SearchWindow& window,
                                      const LevelScan& scan) const;

  // The steps of locate(), also for a group of scans.

  [[nodiscard]] Candidates find_candidates(const KnownMap& map, const SearchWindow& window,
                                           const LevelScan& scan) const;
  /// Matches from a pose that is known to be near.
  [[nodiscard]] std::optional<Candidate> match(const KnownMap& map, const LevelScan& scan,
                                               const geometry::SE2& T_map_guess) const;
  /// Chooses the best place, and decides whether it is believed.
  [[nodiscard]] Relocalisation choose(const Candidates& found, const WallScore& wall_score) const;
  /// The index of the best of some candidates, which must not be empty.
  [[nodiscard]] static std::size_t best_of(std::span<const Candidate> candidates);
  /// The best wall score a few decimetres beside a candidate.
  [[nodiscard]] static double score_beside(const Candidate& candidate, const WallScore& wall_score);

 private:
  RelocaliserParams params_;
  ScanMatcher matcher_;
};

}  // namespace nodmap::slam2d
