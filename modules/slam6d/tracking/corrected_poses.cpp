// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/tracking/corrected_poses.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace nodmap::slam6d {
namespace {

using geometry::SE3;

// How far `sweep` is on the way from one sweep to another, by their numbers.
double fraction_of(std::size_t from, std::size_t sweep, std::size_t to) {
  return static_cast<double>(sweep - from) / static_cast<double>(to - from);
}

// How much of the correction of tracked sweep `to` applies to a sweep between it and `from`.
double fraction_of(const SweepPose& from, const SweepPose& sweep, const SweepPose& to) {
  if (from.odometry_frame != to.odometry_frame && sweep.odometry_frame == from.odometry_frame) {
    return 0.0;
  }
  if (from.odometry_frame != to.odometry_frame && sweep.odometry_frame == to.odometry_frame) {
    return 1.0;
  }
  return fraction_of(from.sweep, sweep.sweep, to.sweep);
}

}  // namespace

void CorrectedPoses::add(const PoseUpdate& update) {
  odometry_frame_ += update.T_first_odom.matrix() == T_first_odom_.matrix() ? 0 : 1;
  T_first_odom_ = update.T_first_odom;
  sweeps_.push_back({.sweep = num_added_++,
                     .stamp = update.stamp,
                     .T_first_base = update.T_first_odom * update.T_odom_base,
                     .T_map_base_online = update.T_map_base,
                     .T_map_base = update.T_map_base,
                     .is_tracked = update.is_tracked(),
                     .is_place_known = update.is_place_known,
                     .odometry_frame = odometry_frame_});
}

void CorrectedPoses::keep_online(const CorrectedPoses& published) {
  for (SweepPose& sweep : sweeps_) {
    const auto before = published.find(sweep.sweep);
    if (before != published.sweeps_.end() && before->sweep == sweep.sweep) {
      sweep.T_map_base_online = before->T_map_base_online;
    }
  }
}

std::vector<SweepPose>::const_iterator CorrectedPoses::find(std::size_t sweep) const {
  return std::ranges::lower_bound(sweeps_, sweep, {}, &SweepPose::sweep);
}

std::span<SweepPose> CorrectedPoses::from(std::size_t sweep) {
  return std::span(sweeps_).subspan(static_cast<std::size_t>(find(sweep) - sweeps_.begin()));
}

bool CorrectedPoses::contains(std::size_t sweep) const {
  const auto found = find(sweep);
  return found != sweeps_.end() && found->sweep == sweep;
}

const SE3& CorrectedPoses::pose_of(std::size_t sweep) const {
  return find(sweep)->T_map_base;
}

void CorrectedPoses::move(std::span<const Correction> corrections) {
  if (corrections.empty()) {
    return;
  }
  std::vector<SE3> T_new_old;
  for (const Correction& correction : corrections) {
    T_new_old.emplace_back(correction.T_map_base * pose_of(correction.sweep).inverse());
  }
  std::size_t c = 0;  // the last one up to the sweep
  for (SweepPose& pose : sweeps_) {
    while (c + 1 < corrections.size() && corrections[c + 1].sweep <= pose.sweep) {
      ++c;
    }
    SE3 moved = T_new_old[c] * pose.T_map_base;
    if (c + 1 < corrections.size() && corrections[c].sweep <= pose.sweep) {
      moved = geometry::interpolate(
          moved, T_new_old[c + 1] * pose.T_map_base,
          fraction_of(corrections[c].sweep, pose.sweep, corrections[c + 1].sweep));
    }
    pose.T_map_base = normalized(moved);
  }
}

std::size_t CorrectedPoses::take_back(std::size_t first) {
  std::size_t num_tracked = 0;
  for (SweepPose& pose : from(first)) {
    num_tracked += std::exchange(pose.is_tracked, false) ? 1 : 0;
  }
  return num_tracked;
}

void CorrectedPoses::place(std::size_t first,
                           const std::function<SE3(const SE3& T_first_base)>& T_map_base_at) {
  for (SweepPose& pose : from(first)) {
    pose.T_map_base = T_map_base_at(pose.T_first_base);
  }
}

void CorrectedPoses::drop_sweeps(std::span<const std::size_t> used) {
  const auto drop = [&] {
    std::erase_if(sweeps_, [&](const SweepPose& pose) {
      return pose.sweep % keep_every_ != 0 && !std::ranges::binary_search(used, pose.sweep);
    });
  };
  max_sweeps_ = std::max(max_sweeps_, 2 * used.size());
  drop();
  // A quarter becomes free, so that this is done seldom.
  while (4 * sweeps_.size() > 3 * max_sweeps_) {
    keep_every_ *= 2;
    drop();
  }
}

std::vector<SE3> CorrectedPoses::trajectory() const {
  std::vector<SE3> poses;
  poses.reserve(sweeps_.size());
  std::optional<std::size_t> tracked;  // the last one so far
  for (std::size_t i = 0; i < sweeps_.size(); ++i) {
    poses.push_back(sweeps_[i].T_map_base);
    if (!sweeps_[i].is_tracked) {
      continue;
    }
    for (std::size_t j = tracked.value_or(i) + 1; j < i; ++j) {
      const SweepPose& last = sweeps_[*tracked];
      // The correction by the registration of the later sweep, in its base frame.
      const SE3 T_map_first = last.T_map_base * last.T_first_base.inverse();
      const SE3 correction =
          (T_map_first * sweeps_[i].T_first_base).inverse() * sweeps_[i].T_map_base;
      poses[j] = T_map_first * sweeps_[j].T_first_base *
                 geometry::interpolate(SE3::Identity(), correction,
                                       fraction_of(last, sweeps_[j], sweeps_[i]));
    }
    tracked = i;
  }
  return poses;
}

}  // namespace nodmap::slam6d
