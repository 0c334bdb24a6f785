// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/geometry/se2.hpp"
#include "common/geometry/time.hpp"
#include "modules/slam2d/back_end/submap_chain.hpp"
#include "modules/slam2d/params.hpp"
#include "modules/slam2d/pose_update.hpp"

namespace nodmap::slam2d {

/// A level scan, stored relative to a keyframe near it: its pose moves with the keyframe.
struct TrackedScan {
  time::Timestamp stamp{};
  std::size_t keyframe = 0;  ///< index
  geometry::SE2 T_keyframe_base;
  geometry::SE2 T_map_base_online;  ///< as it was known when the scan came
};

/// Where the robot was at each level scan. During a drive of hours only every second, then every
/// fourth scan is kept, and so on.
class TrackedPath {
 public:
  explicit TrackedPath(const PathParams& params) : params_(params) {}

  /// Adds the next scan, relative to the newest keyframe.
  void add(const PoseUpdate& update, std::span<const Keyframe> keyframes);

  /// Attaches the scans of dropped keyframes to the keyframe before or, if there is none, to the
  /// one after, and renumbers the others. `keyframes`: those that are left.
  void attach_to_others(const DroppedKeyframes& dropped, std::span<const Keyframe> keyframes);

  /// T_map_base of each of scans(), by the present poses of the keyframes.
  [[nodiscard]] std::vector<geometry::SE2> poses(std::span<const Keyframe> keyframes) const;
  [[nodiscard]] std::span<const TrackedScan> scans() const { return scans_; }

 private:
  PathParams params_;
  std::vector<TrackedScan> scans_;
  std::int64_t added_ = 0;
  std::int64_t record_every_ = 1;  // level scans
};

}  // namespace nodmap::slam2d
