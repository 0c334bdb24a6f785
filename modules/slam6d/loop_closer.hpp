// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/angle.hpp"
#include "common/geometry/se3.hpp"
#include "modules/slam6d/pose_covariance.hpp"
#include "modules/slam6d/registration.hpp"
#include "modules/slam6d/start_poses.hpp"
#include "modules/slam6d/voxel_map.hpp"

namespace nodmap::slam6d {

/// How far from where it is estimated a keyframe is looked for, in standard deviations.
inline constexpr double kReachSigmas = 3.0;

/// When a keyframe is recognised in a place of before.
struct LoopParams {
  bool enabled = true;
  double max_distance_m = 3.0;
  double min_inlier_ratio = 0.5;
  double max_search_m = 6.0;
  double max_search_rad = geometry::deg_to_rad(45.0);
  int min_keyframes = 3;
  double max_disagreement_m = 0.2;
  double max_disagreement_rad = geometry::deg_to_rad(2.0);
  double recent_m = 40.0;
  double certain_m = 0.1;
  double certain_rad = geometry::deg_to_rad(1.0);

  template <class Visitor>
  void describe(Visitor& v) {
    v.flag("enabled", enabled, "Closes loops.");
    v.number("max_distance_m", max_distance_m, {0.1, 100.0},
             "A keyframe is looked for in places of before whose keyframes were this near, or "
             "farther by as much as the drift may be.");
    v.number("min_inlier_ratio", min_inlier_ratio, {0.0, 1.0},
             "A loop of whose points, or of whose points on walls, a smaller part lies on the "
             "place's planes is refused.");
    v.number("max_search_m", max_search_m, {0.0, 100.0},
             "A place is searched for over as much as the drift may be, up to this.");
    v.angle("max_search_deg", max_search_rad, {0.0, 180.0}, "The same for the heading.");
    v.integer("min_keyframes", min_keyframes, {1, 100},
              "A place that was searched for is believed when so many keyframes say the same.");
    v.number("max_disagreement_m", max_disagreement_m, {0.001, 10.0},
             "How far they may put the robot apart, and 2 % of the distance driven between them.");
    v.angle("max_disagreement_deg", max_disagreement_rad, {0.1, 90.0}, "The same for rotations.");
    v.number("recent_m", recent_m, {1.0, 10000.0},
             "What was driven so recently stays in the map: the drift since then is in its walls "
             "already.");
    v.number("certain_m", certain_m, {0.001, 10.0},
             "So does a place of before that is known, relative to the robot, to within this by "
             "three standard deviations: farther apart, two walls would be entered for one.");
    v.angle("certain_deg", certain_rad, {0.01, 90.0}, "The same for rotations.");
  }
};

/// A keyframe recognised in a place of before.
struct Loop {
  std::size_t from = 0;  ///< keyframe of the place
  std::size_t to = 0;    ///< the one that was recognised
  geometry::SE3 T_from_to = geometry::SE3::Identity();
  /// Of position (m) and rotation vector (rad), axes of `from`: of the match alone. About zero
  /// along degenerate directions.
  Matrix6d information = Matrix6d::Zero();
  double inlier_ratio = 0.0;
};

/// Why there is no loop.
enum class LoopRefusal {
  kLowScore,    ///< too few points fit
  kAmbiguous,   ///< another place fits as well
  kUnconfirmed  ///< too few other keyframes say the same so far
};

struct LoopAttempt {
  std::optional<Loop> loop = std::nullopt;
  LoopRefusal refusal = LoopRefusal::kLowScore;  ///< where there is none
};

/// Recognises places: where a keyframe lies in the map of some keyframes of before, and which of
/// several loops agree with each other.
class LoopCloser {
 public:
  LoopCloser(const LoopParams& params, const RegistrationParams& registration);

  /// Matches the voxels of a keyframe with a place, from a pose that is known well enough to find
  /// the way, or else from the best of all poses that the prior allows. In the place's frame.
  [[nodiscard]] LoopAttempt match(VoxelMap& keyframe, const VoxelMap& place,
                                  const PosePrior& prior) const;
  /// Whether the prior is so uncertain that match() has to search.
  [[nodiscard]] static bool needs_search(const PosePrior& prior);

  /// Keeps a loop that was searched for. Each loop puts the newest keyframe somewhere in the map;
  /// loops that agree on the place agree on the drift (pairwise consistency). When those that agree
  /// with this one come from enough keyframes, returns them and drops all others; else none.
  [[nodiscard]] std::vector<Loop> add_pending(const Loop& loop,
                                              std::span<const geometry::SE3> T_map_keyframes);

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
