// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/pose_views.hpp"

namespace nodmap::foxglove {

Json frame_transform(std::int64_t utime_us, const char* parent, const char* child,
                     const geometry::SE3& T_parent_child) {
  return {{"timestamp", time_json(utime_us)},
          {"parent_frame_id", parent},
          {"child_frame_id", child},
          {"translation", vector_json(T_parent_child.translation())},
          {"rotation", quaternion_json(Eigen::Quaterniond(T_parent_child.linear()))}};
}

bool Trail::add(std::int64_t utime_us, const geometry::SE3& T_frame_base) {
  if (!poses_.empty() &&
      (T_frame_base.translation() - poses_.back().translation()).norm() < spacing_m_) {
    return false;
  }
  utime_us_ = utime_us;
  is_new_ = true;
  poses_.push_back(T_frame_base);
  if (poses_.size() > kMaxPoses) {
    poses_.pop_front();
  }
  return true;
}

bool Trail::is_due(std::int64_t utime_us) {
  // A clock set back must not silence the trail until it has caught up.
  const bool is_time =
      !published_us_ || utime_us < *published_us_ || utime_us - *published_us_ >= kPeriodUs;
  if (!is_new_ || !is_time) {
    return false;
  }
  is_new_ = false;
  published_us_ = utime_us;
  return true;
}

Json Trail::poses_in_frame() const {
  Json poses = Json::array();
  for (const geometry::SE3& pose : poses_) {
    poses.push_back(pose_json(pose));
  }
  return {
      {"timestamp", time_json(utime_us_)}, {"frame_id", frame_id_}, {"poses", std::move(poses)}};
}

void KeyframePoses::set(std::int64_t utime_us, const geometry::SE3& T_map_base) {
  poses_[utime_us] = T_map_base;
  if (poses_.size() > kMaxPoses) {
    poses_.erase(poses_.begin());
  }
}

Json KeyframePoses::poses_in_frame() const {
  Json times = Json::array();
  Json poses = Json::array();
  for (const auto& [utime_us, T_map_base] : poses_) {
    times.push_back(time_json(utime_us));
    poses.push_back(pose_json(T_map_base));
  }
  return {{"timestamp", time_json(poses_.empty() ? 0 : poses_.rbegin()->first)},
          {"frame_id", frames::kMap6d},
          {"poses", std::move(poses)},
          {"times", std::move(times)}};
}

}  // namespace nodmap::foxglove
