// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam2d/back_end/tracked_path.hpp"

#include <algorithm>

namespace nodmap::slam2d {

void TrackedPath::add(const PoseUpdate& update, std::span<const Keyframe> keyframes) {
  if (scans_.size() == static_cast<std::size_t>(params_.max_scans)) {
    std::size_t index = 0;
    std::erase_if(scans_, [&index](const TrackedScan&) { return index++ % 2 == 1; });
    record_every_ *= 2;
  }
  if (added_ % record_every_ == 0) {
    const geometry::SE2 T_keyframe_base = keyframes.back().T_map_base.inverse() * update.T_map_base;
    scans_.push_back({update.stamp, keyframes.size() - 1, T_keyframe_base, update.T_map_base});
  }
  ++added_;
}

void TrackedPath::attach_to_others(const DroppedKeyframes& dropped,
                                   std::span<const Keyframe> keyframes) {
  const std::size_t end = dropped.first + dropped.keyframes.size();
  const std::size_t other = std::max<std::size_t>(dropped.first, 1) - 1;
  for (TrackedScan& scan : scans_) {
    if (scan.keyframe >= end) {
      scan.keyframe -= dropped.keyframes.size();
    } else if (scan.keyframe >= dropped.first) {
      const geometry::SE2 T_map_base =
          dropped.keyframes[scan.keyframe - dropped.first].T_map_base * scan.T_keyframe_base;
      scan.keyframe = other;
      scan.T_keyframe_base = keyframes[other].T_map_base.inverse() * T_map_base;
    }
  }
}

std::vector<geometry::SE2> TrackedPath::poses(std::span<const Keyframe> keyframes) const {
  std::vector<geometry::SE2> poses;
  poses.reserve(scans_.size());
  for (const TrackedScan& scan : scans_) {
    poses.push_back(keyframes[scan.keyframe].T_map_base * scan.T_keyframe_base);
  }
  return poses;
}

}  // namespace nodmap::slam2d
