// SPDX-License-Identifier: BSD-3-Clause
#include "modules/slam6d/corrected_poses.hpp"

#include <algorithm>
#include <optional>

namespace nodmap::slam6d {

using geometry::SE3;

void CorrectedPoses::move(std::span<const Correction> corrections) {
  if (corrections.empty()) {
    return;
  }
  const auto change = [this](const Correction& correction) -> SE3 {
    return correction.T_map_base * poses_[correction.sweep].inverse();
  };
  std::vector<SE3> moved = poses_;
  for (std::size_t i = 0; i < corrections.front().sweep; ++i) {
    moved[i] = change(corrections.front()) * poses_[i];
  }
  for (std::size_t c = 0; c < corrections.size(); ++c) {
    const std::size_t first = corrections[c].sweep;
    const bool is_last = c + 1 == corrections.size();
    const std::size_t end = is_last ? poses_.size() : corrections[c + 1].sweep;
    const SE3 T_new_old = change(corrections[c]);
    for (std::size_t i = first; i < end; ++i) {
      moved[i] = T_new_old * poses_[i];
      if (!is_last) {
        const double fraction = static_cast<double>(i - first) / static_cast<double>(end - first);
        moved[i] =
            geometry::interpolate(moved[i], change(corrections[c + 1]) * poses_[i], fraction);
      }
    }
  }
  std::ranges::transform(moved, poses_.begin(), normalized);
}

std::vector<SE3> CorrectedPoses::trajectory(std::span<const PoseUpdate> sweeps) const {
  const auto first_base = [&sweeps](std::size_t i) -> SE3 {
    return sweeps[i].T_first_odom * sweeps[i].T_odom_base;
  };
  std::vector<SE3> poses;
  poses.reserve(sweeps.size());
  std::optional<std::size_t> tracked;  // the last one so far
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    poses.push_back(poses_[i]);
    if (!sweeps[i].is_tracked()) {
      continue;
    }
    for (std::size_t j = tracked.value_or(i) + 1; j < i; ++j) {
      // The correction by the registration of the later sweep, in its base frame.
      const SE3 T_map_first = poses_[*tracked] * first_base(*tracked).inverse();
      const SE3 correction = (T_map_first * first_base(i)).inverse() * poses_[i];
      const double fraction = static_cast<double>(j - *tracked) / static_cast<double>(i - *tracked);
      poses[j] = T_map_first * first_base(j) *
                 geometry::interpolate(SE3::Identity(), correction, fraction);
    }
    tracked = i;
  }
  return poses;
}

}  // namespace nodmap::slam6d
