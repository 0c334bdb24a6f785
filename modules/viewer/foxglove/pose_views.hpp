// SPDX-License-Identifier: BSD-3-Clause
// Where things are, as Foxglove's FrameTransform and PosesInFrame.
#pragma once

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

/// Where something has been: poses at least `spacing_m` apart, the newest `kMaxPoses` of them.
class Trail {
 public:
  static constexpr std::size_t kMaxPoses = 2000;
  /// Each message holds the whole trail: no more often than this.
  static constexpr time::Duration kPeriod = 1s;

  Trail(const char* frame_id, double spacing_m) : frame_id_(frame_id), spacing_m_(spacing_m) {}

  /// Whether the pose was far enough from the last one to be kept.
  bool add(time::Timestamp stamp, const geometry::SE3& T_frame_base);
  void clear() { *this = Trail(frame_id_, spacing_m_); }

  /// Whether there is something new to publish, and the last time is long enough ago. If so, it
  /// counts as published.
  [[nodiscard]] bool is_due(time::Timestamp stamp);

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

/// Where the keyframes of CLOUD are, as far as is known now: they move when a loop is closed. The
/// newest `kMaxPoses` of them.
class KeyframePoses {
 public:
  static constexpr std::size_t kMaxPoses = 2000;

  /// The pose of the keyframe of this time, known or new.
  void set(time::Timestamp stamp, const geometry::SE3& T_map_base);
  void clear() { poses_.clear(); }

  /// foxglove.PosesInFrame, and besides `times`, by which a page finds the cloud of each pose.
  [[nodiscard]] Json poses_in_frame() const;

 private:
  std::map<time::Timestamp, geometry::SE3> poses_;  // by time
};

}  // namespace nodmap::foxglove
