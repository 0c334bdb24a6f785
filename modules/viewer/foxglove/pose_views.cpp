// SPDX-License-Identifier: BSD-3-Clause
#include "modules/viewer/foxglove/pose_views.hpp"

namespace nodmap::foxglove {

Json frame_transform(time::Timestamp stamp, const char* parent, const char* child,
                     const geometry::SE3& T_parent_child) {
  return {{"timestamp", time_json(stamp)},
          {"parent_frame_id", parent},
          {"child_frame_id", child},
          {"translation", vector_json(T_parent_child.translation())},
          {"rotation", quaternion_json(Eigen::Quaterniond(T_parent_child.linear()))}};
}

bool Trail::add(time::Timestamp stamp, const geometry::SE3& T_frame_base) {
  if (!poses_.empty() &&
      (T_frame_base.translation() - poses_.back().translation()).norm() < spacing_m_) {
    return false;
  }
  stamp_ = stamp;
  is_new_ = true;
  poses_.push_back(T_frame_base);
  if (poses_.size() > kMaxPoses) {
    poses_.pop_front();
  }
  return true;
}

bool Trail::take_turn(time::Timestamp stamp) {
  // After the clock was set back, the trail continues at once.
  const bool is_time =
      !published_at_ || stamp < *published_at_ || stamp - *published_at_ >= kPeriod;
  if (!is_new_ || !is_time) {
    return false;
  }
  is_new_ = false;
  published_at_ = stamp;
  return true;
}

Json Trail::poses_in_frame() const {
  Json poses = Json::array();
  for (const geometry::SE3& pose : poses_) {
    poses.push_back(pose_json(pose));
  }
  return {{"timestamp", time_json(stamp_)}, {"frame_id", frame_id_}, {"poses", std::move(poses)}};
}

void KeyframePoses::set(time::Timestamp stamp, const geometry::SE3& T_map_base) {
  poses_[stamp] = T_map_base;
  if (poses_.size() > kMaxPoses) {
    poses_.erase(poses_.begin());
  }
}

void KeyframePoses::move_to(const std::map<time::Timestamp, geometry::SE3>& T_map_base) {
  std::optional<geometry::SE3> correction;
  for (const auto& [stamp, pose] : T_map_base) {
    if (const auto known = poses_.find(stamp); known != poses_.end()) {
      correction = pose * known->second.inverse();
      break;
    }
  }
  for (auto& [stamp, pose] : poses_) {
    if (const auto moved = T_map_base.find(stamp); moved != T_map_base.end()) {
      correction = moved->second * pose.inverse();
      pose = moved->second;
    } else if (correction) {
      pose = *correction * pose;
    }
  }
  for (const auto& [stamp, pose] : T_map_base) {
    set(stamp, pose);
  }
}

Json KeyframePoses::poses_in_frame() const {
  Json times = Json::array();
  Json poses = Json::array();
  for (const auto& [stamp, T_map_base] : poses_) {
    times.push_back(time_json(stamp));
    poses.push_back(pose_json(T_map_base));
  }
  return {{"timestamp", time_json(poses_.empty() ? time::Timestamp{} : poses_.rbegin()->first)},
          {"frame_id", frames::kMap6d},
          {"poses", std::move(poses)},
          {"times", std::move(times)}};
}

}  // namespace nodmap::foxglove
