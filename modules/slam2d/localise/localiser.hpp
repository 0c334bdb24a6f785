// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "common/geometry/time.hpp"
#include "modules/slam2d/front_end/doubt.hpp"
#include "modules/slam2d/front_end/pose_covariance.hpp"
#include "modules/slam2d/localise/known_map.hpp"
#include "modules/slam2d/localise/relocaliser.hpp"
#include "modules/slam2d/matching/pose_search.hpp"
#include "modules/slam2d/matching/scan_matcher.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/pose_update.hpp"
#include "modules/slam2d/scan/level_scan.hpp"

namespace nodmap::slam2d {

struct LocaliserMetrics {
  ScansByState scans;
  SearchCounts searches;        ///< of the whole map
  std::int64_t times_lost = 0;  ///< after its place was confirmed
};

/// Localises in a known map, which it never changes: level scans are matched against it from the
/// pose by odometry. At the start, or once the robot is lost, the whole map is searched; after a
/// gap in odometry, what was in reach.
class Localiser {
 public:
  /// `map` must outlive this. `T_map_start`: where the robot is at the first scan, if known.
  Localiser(const Slam2dParams& params, const KnownMap& map,
            const std::optional<geometry::SE2>& T_map_start);

  /// Takes the next level scan and returns its pose. Until the robot has been found for the first
  /// time, the pose has no meaning, and its state is kLost.
  PoseUpdate add_scan(const LevelScan& scan);

  [[nodiscard]] const LocaliserMetrics& metrics() const { return metrics_; }

 private:
  enum class State : std::uint8_t { kLost, kUnconfirmed, kLocated };

  struct FailedSearch {
    time::Timestamp stamp{};
    geometry::SE2 T_odom_base;
  };

  void begin_doubt_after_gap(const LevelScan& scan);
  [[nodiscard]] PoseUpdate track(const LevelScan& scan);
  [[nodiscard]] PoseUpdate search_whole_map(const LevelScan& scan);
  [[nodiscard]] std::optional<Match> match(const LevelScan& scan);
  [[nodiscard]] std::optional<Match> match_in_doubt(const LevelScan& scan);
  [[nodiscard]] bool fits(const LevelScan& scan, const Match& match) const;
  void take_place(const geometry::SE2& T_map_base, const LevelScan& scan);
  void confirm(const LevelScan& scan);
  void follow_odometry(const LevelScan& scan, PoseUpdate& update);
  [[nodiscard]] bool is_misfit_lost(time::Timestamp stamp) const;
  [[nodiscard]] bool is_search_due(const LevelScan& scan) const;

  Slam2dParams params_;
  const KnownMap& map_;
  ScanMatcher matcher_;
  PoseSearch search_;
  Relocaliser relocaliser_;
  State state_ = State::kLost;
  std::optional<geometry::SE2> T_map_start_;
  geometry::SE2 T_map_odom_;
  PoseCovariance covariance_;
  std::optional<geometry::SE2> T_odom_last_;  // of the last level scan
  geometry::SE2 T_odom_found_;                // where the place was found
  Doubt doubt_;                               // about odometry, after a gap in it
  std::optional<time::Timestamp> misfit_since_;
  /// The last search that did not tell the place, in the whole map or around odometry.
  std::optional<FailedSearch> failed_search_;
  LocaliserMetrics metrics_;
};

}  // namespace nodmap::slam2d
