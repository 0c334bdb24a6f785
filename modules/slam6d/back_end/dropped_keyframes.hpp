// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/geometry/se3.hpp"
#include "modules/slam6d/back_end/keyframe.hpp"
#include "modules/slam6d/model/replaced_keyframe.hpp"
#include "modules/slam6d/tracking/corrected_poses.hpp"

namespace nodmap::slam6d {

/// The sweeps whose keyframes were dropped. Each moves with the keyframe that replaces its own, so
/// the trajectory stays whole.
class DroppedKeyframes {
 public:
  /// Drops a keyframe, the sweeps between it and the next one, and those at its place: where there
  /// are so many keyframes, those alone determine the planes. `is_restored`: the keyframe comes
  /// from a saved map, so it has no sweep in this drive.
  void drop(const ReplacedKeyframe& replaced, bool is_restored, const CorrectedPoses& poses,
            std::vector<Keyframe>& keyframes, std::vector<IntermediateSweep>& between);

  /// The new poses of these sweeps when the keyframes move to `T_map_keyframes`.
  [[nodiscard]] std::vector<CorrectedPoses::Correction> corrections(
      std::span<const Keyframe> keyframes, std::span<const geometry::SE3> T_map_keyframes,
      const CorrectedPoses& poses) const;

  /// Forgets the sweeps that `poses` does not keep.
  void forget_sweeps_not_in(const CorrectedPoses& poses);
  /// Drops sweeps of a path that is full, but none that `keyframes` and `between` need.
  void make_room(CorrectedPoses& poses, std::span<const Keyframe> keyframes,
                 std::span<const IntermediateSweep> between);
  void clear() { sweeps_.clear(); }

 private:
  struct Sweep {
    std::size_t sweep;
    std::size_t keyframe;  ///< that it moves with
  };
  std::vector<Sweep> sweeps_;
};

}  // namespace nodmap::slam6d
