// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/back_end/dropped_keyframes.hpp"

#include <algorithm>

namespace nodmap::slam6d {

using geometry::SE3;

void DroppedKeyframes::drop(const ReplacedKeyframe& replaced, bool is_restored,
                            const CorrectedPoses& poses, std::vector<Keyframe>& keyframes,
                            std::vector<IntermediateSweep>& between) {
  const Keyframe& dropped = keyframes[replaced.index];
  const std::size_t next_sweep = keyframes[replaced.index + 1].sweep;
  std::erase_if(between, [&](const IntermediateSweep& sweep) {
    return (dropped.sweep < sweep.sweep && sweep.sweep < next_sweep) ||
           shows_the_same(poses.pose_of(sweep.sweep), dropped.T_map_base);
  });
  if (!is_restored) {
    sweeps_.push_back({dropped.sweep, replaced.index});
  }
  for (Sweep& sweep : sweeps_) {
    sweep.keyframe = replaced.renumbered(sweep.keyframe);
  }
  keyframes.erase(keyframes.begin() + static_cast<std::ptrdiff_t>(replaced.index));
}

std::vector<CorrectedPoses::Correction> DroppedKeyframes::corrections(
    std::span<const Keyframe> keyframes, std::span<const SE3> T_map_keyframes,
    const CorrectedPoses& poses) const {
  std::vector<CorrectedPoses::Correction> corrections;
  for (const Sweep& sweep : sweeps_) {
    corrections.push_back({sweep.sweep, T_map_keyframes[sweep.keyframe] *
                                            keyframes[sweep.keyframe].T_map_base.inverse() *
                                            poses.pose_of(sweep.sweep)});
  }
  return corrections;
}

void DroppedKeyframes::make_room(CorrectedPoses& poses, std::span<const Keyframe> keyframes,
                                 std::span<const IntermediateSweep> between) {
  std::vector<std::size_t> used;
  const auto use = [&used](const auto& kept) { used.push_back(kept.sweep); };
  std::ranges::for_each(keyframes, use);
  std::ranges::for_each(between, use);
  std::ranges::sort(used);
  poses.drop_sweeps(used);
  forget_sweeps_not_in(poses);
}

void DroppedKeyframes::forget_sweeps_not_in(const CorrectedPoses& poses) {
  std::erase_if(sweeps_, [&](const Sweep& sweep) { return !poses.contains(sweep.sweep); });
}

}  // namespace nodmap::slam6d
