// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "modules/slam6d/model/replaced_keyframe.hpp"
#include "modules/slam6d/model/voxel_map.hpp"
#include "modules/slam6d/registration/matrix6d.hpp"
#include "modules/slam6d/registration/registration.hpp"
#include "modules/slam6d/registration/start_poses.hpp"

namespace nodmap::slam6d {

/// Loops are searched for up to this many standard deviations from the estimated pose.
inline constexpr double kReachSigmas = 3.0;

/// A keyframe matched with earlier places: which places, and which matches count.
struct LoopMatchParams {
  double max_distance_m = 3.0;
  double min_inlier_ratio = 0.5;

  template <class Visitor>
  void describe(Visitor& v) {
    v.number(
        "max_distance_m", max_distance_m, {0.1, 100.0},
        "A keyframe is matched with earlier places within this distance, plus the possible drift.");
    v.number("min_inlier_ratio", min_inlier_ratio, {0.0, 1.0},
             "A loop is refused if less than this fraction of the keyframe's points, or of its "
             "points on walls, lies on the planes of the place.");
  }
};

/// The search for a loop where the drift is too large for a match alone.
struct LoopSearchParams {
  double max_distance_m = 6.0;
  double max_rotation_rad = geometry::deg_to_rad(45.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.number("max_distance_m", max_distance_m, {0.0, 100.0},
             "A loop is searched for within the possible drift, at most up to this distance.");
    v.angle("max_rotation_deg", max_rotation_rad, {0.0, 180.0}, "The same for the heading.");
  }
};

/// When loops that were searched for are believed.
struct LoopConsensusParams {
  int min_keyframes = 3;
  double max_distance_m = 0.2;
  double max_rotation_rad = geometry::deg_to_rad(2.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.integer(
        "min_keyframes", min_keyframes, {1, 100},
        "A loop found by a search is accepted when this many keyframes lead to the same pose.");
    v.number("max_distance_m", max_distance_m, {0.001, 10.0},
             "Poses of the robot count as the same within this distance plus 2 % of the distance "
             "driven between the keyframes.");
    v.angle("max_rotation_deg", max_rotation_rad, {0.1, 90.0}, "The same for rotations.");
  }
};

/// When a keyframe counts as recognised at an earlier place.
struct LoopParams {
  bool enabled = true;
  LoopMatchParams match{};
  LoopSearchParams search{};
  LoopConsensusParams consensus{};
  double recent_m = 40.0;
  double certain_m = 0.1;
  double certain_rad = geometry::deg_to_rad(1.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.flag("enabled", enabled, "Close loops.");
    v.section("match", match);
    v.section("search", search);
    v.section("consensus", consensus);
    v.number("recent_m", recent_m, {1.0, 10000.0},
             "Keyframes on the last part of the path, of this length, stay in the map: it contains "
             "the drift since then already.");
    v.number("certain_m", certain_m, {0.001, 10.0},
             "Earlier keyframes also stay in the map if three standard deviations of their "
             "position relative to the robot are below this. With a larger error, a wall would be "
             "entered twice.");
    v.angle("certain_deg", certain_rad, {0.01, 90.0}, "The same for rotations.");
  }
};

/// A keyframe recognised at an earlier place.
struct Loop {
  std::size_t from = 0;  ///< keyframe of the place
  std::size_t to = 0;    ///< keyframe that was recognised
  geometry::SE3 T_from_to = geometry::SE3::Identity();
  /// Inverse covariance of position (m) and rotation vector (rad) in the axes of `from`, from the
  /// match alone. About zero along degenerate directions.
  Matrix6d information = Matrix6d::Zero();
};

/// Why there is no loop.
enum class LoopRefusal : std::uint8_t {
  kLowScore,    ///< too few points fit
  kAmbiguous,   ///< another place fits as well
  kUnconfirmed  ///< too few other keyframes agree so far
};

struct LoopAttempt {
  std::optional<Loop> loop = std::nullopt;
  LoopRefusal refusal = LoopRefusal::kLowScore;  ///< where there is none
};

/// Recognises places: finds the pose of a keyframe in the map of some earlier keyframes, and
/// decides which of several loops agree.
class LoopCloser {
 public:
  LoopCloser(const LoopParams& params, const RegistrationParams& registration);

  /// Registers the voxels of a keyframe with a place, in the place's frame: from the prior's pose
  /// if that is certain enough for registration to converge, otherwise from the best of all poses
  /// that the prior allows.
  [[nodiscard]] LoopAttempt match(VoxelMap& keyframe, const VoxelMap& place,
                                  const PosePrior& prior) const;
  /// Whether the prior is so uncertain that match() has to search.
  [[nodiscard]] static bool needs_search(const PosePrior& prior);

  /// Keeps a loop that was found by a search. Each loop gives a pose of the newest keyframe in the
  /// map; loops that give the same pose agree on the drift (pairwise consistency). Returns the
  /// loops that agree with this one, and drops all others, once they come from enough keyframes;
  /// otherwise returns none.
  [[nodiscard]] std::vector<Loop> add_pending(const Loop& loop,
                                              std::span<const geometry::SE3> T_map_keyframes);
  /// Forgets the pending loops of a dropped keyframe, and renumbers the others.
  void drop_keyframe(const ReplacedKeyframe& replaced);

 private:
  [[nodiscard]] LoopAttempt attempt(const Registration& found, const PosePrior& prior) const;
  [[nodiscard]] LoopAttempt search(VoxelMap& keyframe, const VoxelMap& place,
                                   const PosePrior& prior) const;
  [[nodiscard]] std::vector<StartPose> starts(const VoxelMap& keyframe, const VoxelMap& place,
                                              const PosePrior& prior) const;

  LoopParams params_;
  RegistrationParams registration_;
  std::vector<Loop> pending_;
};

}  // namespace nodmap::slam6d
