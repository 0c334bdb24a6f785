// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "common/geometry/time.hpp"
#include "modules/slam6d/back_end/keyframe.hpp"
#include "modules/slam6d/localise/relocaliser.hpp"
#include "modules/slam6d/localise/seen_space.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/pose_update.hpp"
#include "modules/slam6d/sweep/sweep_cloud.hpp"

namespace nodmap::slam6d {

/// When the robot counts as found in a map that was made before, and when the place is given up.
struct LocaliseParams {
  RelocaliserParams place{};
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
             "A confirmed place may be contradicted by up to this many times "
             "localise.max_contradiction_ratio.");
    v.number("confirm_distance_m", confirm_distance_m, {0.0, 100.0},
             "A place that was searched for is confirmed by a sweep this far from where it was "
             "found, if all sweeps on the way fit; until then poses are DEGRADED.");
    v.integer("max_lost_sweeps", max_lost_sweeps, {1, 1000},
              "After this many sweeps in a row that do not fit, the robot is searched for in the "
              "whole map: in the saved one or, while it maps, in its own.");
    v.number("certain_m", certain_m, {0.0, 100.0},
             "After the robot was LOST while it maps, a match is refused if it contradicts the "
             "map. This is not checked while three standard deviations of the position by odometry "
             "are below this, because then no other place is possible.");
    v.angle("certain_deg", certain_rad, {0.0, 180.0},
            "The same limit for the orientation; both must be met.");
    v.number("search_again_m", search_again_m, {0.0, 100.0},
             "A search that found nothing is repeated after the robot has moved by this distance.");
    v.angle("search_again_deg", search_again_rad, {0.0, 180.0},
            "A search that found nothing is repeated after the robot has rotated by this angle.");
    v.number("search_again_s", search_again_s, {0.0, 3600.0},
             "A search that found nothing is repeated after this time, because something else may "
             "have moved.");
  }
};

/// Decides where the robot is in a map that was made before: gives the place at which tracking
/// begins, and gives it up when sweeps do not fit. In between Tracker registers them.
///
/// A place that was found by a search is confirmed when a sweep farther on fits, too, because that
/// sweep sees something else. Until then the place is given up at the first sweep that does not
/// fit, and when the sweeps so far look through surfaces of the map. A start pose is believed at
/// once, but confirmed in the same way. Any place, even a confirmed one, is given up when several
/// sweeps show surfaces where the map is known to be free.
class Localiser {
 public:
  /// `T_map_start`: the pose of the robot at the first sweep, if it is known. `keyframes`: those of
  /// `map`.
  Localiser(const LocaliseParams& params, const RegistrationParams& registration,
            std::span<const Keyframe> keyframes, const VoxelMap& map,
            const std::optional<geometry::SE3>& T_map_start);

  /// Whether the robot has a place, confirmed or not.
  [[nodiscard]] bool has_place() const { return state_ != State::kUnknown; }
  [[nodiscard]] bool is_confirmed() const { return state_ == State::kConfirmed; }
  /// Whether the place is the given start pose.
  [[nodiscard]] bool is_told() const { return is_told_; }

  /// A sweep as voxels in base, and the same with its beams.
  struct Sweep {
    const VoxelMap& voxels;
    const SweepCloud& cloud;
  };

  /// To be called while the robot has no place. Returns its pose: the start pose, or the only place
  /// that fits the sweep. `by_odometry`: the update of the sweep; only its pose in odom is used.
  [[nodiscard]] std::optional<geometry::SE3> find(const Sweep& sweep, const VoxelMap& map,
                                                  const PoseUpdate& by_odometry);

  /// Confirms or doubts the place by the registration of a sweep. Unless the place was given, the
  /// pose is DEGRADED as long as the place is not confirmed, and also if most of the sweep is not
  /// in the map. `lost_sweeps`: sweeps refused in a row, including this one.
  void classify(const Sweep& sweep, const VoxelMap& map, PoseUpdate& update, int lost_sweeps);

  /// Whether too many of a sweep's surfaces stand where the map's beams went through.
  [[nodiscard]] bool is_contradicted_at(const VoxelMap& sweep_base,
                                        const geometry::SE3& T_map_base) const {
    return seen_.compare(sweep_base, T_map_base).contradiction_ratio() >
           params_.place.max_contradiction_ratio;
  }

  /// Forgets where the robot was: it has been lost again.
  void forget_place();

  /// Continues with odometry in another frame: somebody may have carried the robot.
  void change_odometry_frame() { failed_.reset(); }

  struct Metrics {
    std::int64_t searches = 0;
    std::int64_t found = 0;
    std::int64_t times_lost = 0;
    std::int64_t times_contradicted = 0;  ///< of those lost
  };
  [[nodiscard]] const Metrics& metrics() const { return metrics_; }
  /// To be called at first if this replaces a localiser, with its metrics().
  void count_from(const Metrics& metrics) { metrics_ = metrics; }

 private:
  enum class State : std::uint8_t { kUnknown, kUnconfirmed, kConfirmed };
  struct Failure {
    time::Timestamp stamp{};
    geometry::SE3 T_odom_base = geometry::SE3::Identity();
  };
  [[nodiscard]] bool is_search_due(const PoseUpdate& by_odometry) const;
  [[nodiscard]] bool is_doubtful() const { return state_ == State::kUnconfirmed && !is_told_; }
  [[nodiscard]] bool confirms(const geometry::SE3& T_map_base) const;
  [[nodiscard]] bool is_possible(const Sweep& sweep, const VoxelMap& map,
                                 const geometry::SE3& T_map_base) const;
  void add_evidence(const Sweep& sweep, const VoxelMap& map, const PoseUpdate& update);
  [[nodiscard]] bool is_contradicted() const;
  [[nodiscard]] bool is_too_much_missing(const Evidence& missing) const {
    return missing.contradiction_ratio() > params_.place.max_missing_ratio;
  }
  void begin_place(const geometry::SE3& T_map_base);
  void give_up();

  LocaliseParams params_;
  SeenSpace seen_;
  Relocaliser search_;
  std::optional<geometry::SE3> T_map_start_;
  State state_ = State::kUnknown;
  bool is_told_ = false;  // the place, by the start pose
  geometry::SE3 T_map_found_ = geometry::SE3::Identity();
  Evidence evidence_;              // of the sweeps since then, the newest most, against the map
  SeenSpace seen_here_;            // by these sweeps, until the place is confirmed
  Evidence missing_;               // of the map's surfaces around the robot, against these sweeps
  std::optional<Failure> failed_;  ///< the last search, if it found nothing
  Metrics metrics_;
};

}  // namespace nodmap::slam6d
