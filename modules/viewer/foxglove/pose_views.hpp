// SPDX-License-Identifier: BSD-3-Clause
// Poses as Foxglove's FrameTransform and PosesInFrame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>

#include "common/geometry/time.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"

namespace nodmap::foxglove {

/// foxglove.FrameTransform.
[[nodiscard]] Json frame_transform(time::Timestamp stamp, const char* parent, const char* child,
                                   const geometry::SE3& T_parent_child);

/// A path: poses at least `spacing_m` apart, the newest `kMaxPoses` of them.
class Trail {
 public:
  static constexpr std::size_t kMaxPoses = 2000;
  /// Shortest time between two messages, because each contains the whole trail.
  static constexpr time::Duration kPeriod = 1s;

  Trail(const char* frame_id, double spacing_m) : frame_id_(frame_id), spacing_m_(spacing_m) {}

  /// Adds a pose if it is far enough from the last one; returns whether it was added.
  bool add(time::Timestamp stamp, const geometry::SE3& T_frame_base);
  void clear() { *this = Trail(frame_id_, spacing_m_); }

  /// Returns true if the trail has changed and the last publication is long enough ago. It then
  /// counts as published now.
  [[nodiscard]] bool take_turn(time::Timestamp stamp);

  [[nodiscard]] std::size_t size() const { return poses_.size(); }

  /// foxglove.PosesInFrame.
  [[nodiscard]] Json poses_in_frame() const;

 private:
  const char* frame_id_;
  double spacing_m_;
  time::Timestamp stamp_{};
  bool is_new_ = false;
  std::optional<time::Timestamp> published_at_;
  std::deque<geometry::SE3> poses_;
};

/// The present poses of the newest `kMaxPoses` keyframes of CLOUD; loop closures move them.
class KeyframePoses {
 public:
  static constexpr std::size_t kMaxPoses = 2000;

  /// Sets the pose of a keyframe, identified by its stamp.
  void set(time::Timestamp stamp, const geometry::SE3& T_map_base);
  /// Sets the poses of all keyframes that the map has, by stamp. The others, which it has dropped,
  /// are still shown: each moves with the one before it, or else with the first.
  void move_to(const std::map<time::Timestamp, geometry::SE3>& T_map_base);
  void clear() { poses_.clear(); }

  /// foxglove.PosesInFrame with an additional field `times`, by which a page finds the cloud of
  /// each pose.
  [[nodiscard]] Json poses_in_frame() const;

 private:
  std::map<time::Timestamp, geometry::SE3> poses_;  // by time
};

}  // namespace nodmap::foxglove
