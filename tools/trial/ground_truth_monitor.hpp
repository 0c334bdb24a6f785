// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "common/bus/loop_bus.hpp"
#include "common/geometry/pose_history.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/scan_t.hpp"
#include "sim/body/robot_model.hpp"
#include "sim/world/ray_caster.hpp"
#include "tools/trial/brake_latency.hpp"
#include "tools/trial/occupancy_metrics.hpp"
#include "tools/trial/record.hpp"

namespace nodmap::trial {

/// Records the true state and the messages from which a trial is evaluated, and publishes TRUTH, to
/// which no part of the robot subscribes.
class GroundTruthMonitor {
 public:
  /// `p_base_mirror`: the laser's mirror at pitch 0, metres. `map`: the OctoMap of 6D SLAM.
  GroundTruthMonitor(const sim::World& world, const sim::RobotModel& model,
                     bus::LoopNetwork& network, BrakeLatencyMonitor brake_latency,
                     const Eigen::Vector3d& p_base_mirror, const slam6d::TraceParams& map);

  /// To be called every millisecond of simulated time.
  void update();

  [[nodiscard]] const TrialRecord& record() const { return record_; }
  [[nodiscard]] const BrakeLatencyMonitor& brake_latency() const { return brake_latency_; }
  /// True poses of base by message time.
  [[nodiscard]] const geometry::PoseHistory& T_world_base() const { return T_world_base_; }
  [[nodiscard]] const ObservedVoxels& observed_voxels() const { return observed_voxels_; }

 private:
  void subscribe();
  void record_refusal(const nodmap::navigation_t& message);
  void on_scan(const nodmap::scan_t& message);
  void on_pitch_state(const nodmap::pitch_state_t& message);
  void record_progress(const Eigen::Vector2d& position);
  void publish(const sim::GroundTruth& truth);
  void update_brake_latency(const sim::GroundTruth& truth);
  [[nodiscard]] bool is_visible(const sim::ActorState& actor, const sim::GroundTruth& truth) const;

  sim::World world_;
  const sim::RobotModel& model_;
  sim::RayCaster caster_;  // without actors
  bus::LoopBus bus_;
  BrakeLatencyMonitor brake_latency_;
  Eigen::Vector3d p_base_mirror_;
  TrialRecord record_;
  geometry::PoseHistory T_world_base_;
  ObservedVoxels observed_voxels_;
  std::optional<std::int64_t> sweep_;
  std::optional<time::Timestamp> reversed_;  // when sweep_ began, unless the head came from rest
  std::int64_t reached_goal_utime_ = 0;      // of the last goal at which the robot has arrived
  bool reports_slip_ = false;                // the navigator, with its last NAVIGATION
  std::int64_t truth_seq_ = 0;
};

}  // namespace nodmap::trial
