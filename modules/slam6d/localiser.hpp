// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "modules/slam6d/keyframe.hpp"
#include "modules/slam6d/place_search.hpp"
#include "modules/slam6d/pose_update.hpp"
#include "modules/slam6d/seen_space.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// When the robot is found in a map that was made before, and when it no longer is.
struct LocaliseParams {
  PlaceSearchParams place{};
  SeenSpaceParams seen{};
  double confirmed_tolerance = 3.0;
  double confirm_distance_m = 3.0;
  int max_lost_sweeps = 5;
  double certain_m = 0.3;
  double certain_rad = geometry::deg_to_rad(10.0);
  double search_again_m = 0.1;
  double search_again_rad = geometry::deg_to_rad(11.5);
  double search_again_s = 5.0;

  template <class Visitor>
  void describe(Visitor& v) {
    place.describe(v);
    seen.describe(v);
    v.number("confirmed_tolerance", confirmed_tolerance, {1.0, 50.0},
             "By how much more a place that is confirmed may be contradicted.");
    v.number("confirm_distance_m", confirm_distance_m, {0.0, 100.0},
             "A place that was searched for is confirmed by a sweep this far from where it was "
             "found, if all sweeps on the way fit; until then poses are DEGRADED.");
    v.integer("max_lost_sweeps", max_lost_sweeps, {1, 1000},
              "After so many sweeps in a row that do not fit the known map the robot is searched "
              "for in the whole map; so many in a row also while the robot maps.");
    v.number("certain_m", certain_m, {0.0, 100.0},
             "A match of a robot that was LOST while it maps is refused where it contradicts the "
             "map; not where odometry is certain to this, three standard deviations, as no other "
             "place is so near.");
    v.angle("certain_deg", certain_rad, {0.0, 180.0}, "And to this in its orientation.");
    v.number("search_again_m", search_again_m, {0.0, 100.0},
             "A search that found nothing is repeated from so far away.");
    v.angle("search_again_deg", search_again_rad, {0.0, 180.0},
            "Or after a rotation by this much.");
    v.number("search_again_s", search_again_s, {0.0, 3600.0},
             "Or after so long: things may have moved.");
  }
};

/// Whether it is known where the robot is in a map that was made before. Tells the place where
/// tracking begins, and gives it up when sweeps do not fit.
///
/// A place that was searched for is confirmed by a sweep farther on that fits, too: what it sees
/// differs. Until then it is given up with the first that does not. A place, also a confirmed one,
/// is given up when sweep after sweep sees surfaces where the map is known to be free.
class Localiser {
 public:
  /// `T_map_start`: where the robot is at the first sweep, if that is known. `keyframes`: those of
  /// `map`.
  Localiser(const LocaliseParams& params, const RegistrationParams& registration,
            std::span<const Keyframe> keyframes, const VoxelMap& map,
            const std::optional<geometry::SE3>& T_map_start);

  /// Whether it is known where the robot is, though perhaps not yet confirmed.
  [[nodiscard]] bool has_place() const { return state_ != State::kUnknown; }
  [[nodiscard]] bool is_confirmed() const { return state_ >= State::kConfirmed; }

  /// Where the robot is while it has no place: at its start, or where one place alone fits the
  /// sweep. `by_odometry`: the sweep's pose, of which the one in odom counts.
  [[nodiscard]] std::optional<geometry::SE3> find(const VoxelMap& sweep_base, const VoxelMap& map,
                                                  const PoseUpdate& by_odometry);

  /// Confirms or doubts the place by the registration of a sweep. A pose at a place that is not
  /// confirmed is DEGRADED, and so is that of a sweep which the map mostly does not know, unless
  /// the place was told.
  /// `lost_sweeps`: refused in a row up to this one.
  void classify(const VoxelMap& sweep_base, PoseUpdate& update, int lost_sweeps);

  /// Whether too many of a sweep's surfaces stand where the map's beams went through.
  [[nodiscard]] bool is_contradicted_at(const VoxelMap& sweep_base,
                                        const geometry::SE3& T_map_base) const {
    return seen_.compare(sweep_base, T_map_base).contradiction_ratio() >
           params_.place.max_contradiction_ratio;
  }

  /// Odometry goes on in another frame: somebody may have carried the robot.
  void change_odometry_frame() { failed_.reset(); }

  struct Metrics {
    std::int64_t searches = 0;
    std::int64_t found = 0;
    std::int64_t times_lost = 0;
    std::int64_t times_contradicted = 0;  ///< of those lost
  };
  [[nodiscard]] const Metrics& metrics() const { return metrics_; }

 private:
  enum class State { kUnknown, kUnconfirmed, kConfirmed, kTold };
  struct Failure {
    time::Timestamp stamp{};
    geometry::SE3 T_odom_base = geometry::SE3::Identity();
  };
  [[nodiscard]] bool is_search_due(const PoseUpdate& by_odometry) const;
  void add_evidence(const Evidence& evidence);
  [[nodiscard]] bool is_contradicted() const;
  void give_up();

  LocaliseParams params_;
  SeenSpace seen_;
  PlaceSearch search_;
  std::optional<geometry::SE3> T_map_start_;
  State state_ = State::kUnknown;
  geometry::SE3 T_map_found_ = geometry::SE3::Identity();
  Evidence evidence_;              // since then, the newest sweeps most
  std::optional<Failure> failed_;  ///< the last search, if it found nothing
  Metrics metrics_;
};

}  // namespace nodmap::slam6d
