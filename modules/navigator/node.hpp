// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "common/geometry/pose_history.hpp"
#include "common/geometry/time.hpp"
#include "common/node/message_input.hpp"
#include "common/node/node.hpp"
#include "modules/navigator/display.hpp"
#include "modules/navigator/geofence.hpp"
#include "modules/navigator/messages.hpp"
#include "modules/navigator/navigator.hpp"
#include "modules/navigator/senders.hpp"
#include "modules/navigator/slip.hpp"
#include "modules/navigator/staleness.hpp"
#include "nodmap/base_sensors_t.hpp"
#include "nodmap/drive_t.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/pitch_command_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/scan_t.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::navigator {

/// Receives SCAN, OBSTACLE_MAP, ODOMETRY and the state of the scanner; publishes DRIVE and
/// NAVIGATION: one for each obstacle map and, while the robot halts, one for each ODOMETRY.
class NavigatorNode final : public node::Node {
 public:
  using Params = NavigatorParams;

  NavigatorNode(node::Context& context, const Params& params);

  void write_results(const std::filesystem::path& /*dir*/) override {}
  [[nodiscard]] nlohmann::json metrics() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  struct Odometry {
    std::int64_t seq = 0;
    geometry::SE2 T_odom_base;
    double forward_mps = 0.0;
    double yaw_rate_rad_s = 0.0;
  };
  struct ObstacleMap {
    geometry::SE2 T_odom_map;  // of base at the map's stamp
    Points points_map;
  };

  void on_map(const nodmap::egomap_t& message);
  void on_scan(const nodmap::scan_t& message);
  void on_base_sensors(const nodmap::base_sensors_t& message);
  void on_odometry(const nodmap::odometry_t& message);
  void on_pitch_command(const nodmap::pitch_command_t& message);
  void on_pitch_state(const nodmap::pitch_state_t& message);
  void on_goal(const nodmap::goal_t& message);
  void on_pose(const nodmap::pose_t& message);
  void on_stop(const nodmap::stop_t& message);

  void watch_slip(const nodmap::pose_t& message);
  [[nodiscard]] bool may_be_at_goal() const;
  [[nodiscard]] bool laser_is_held() const;
  /// The fastest speed that the pitch controller and the pose allow.
  [[nodiscard]] double max_forward_mps() const;
  void begin_odometry_frame(time::Timestamp stamp);
  [[nodiscard]] Decision halt(Reason reason);
  [[nodiscard]] std::optional<Reason> reason_not_to_drive(const StalenessParams& limits) const;
  [[nodiscard]] std::optional<Reason> reason_by_geofence() const;
  [[nodiscard]] GoalState goal_state() const;
  [[nodiscard]] Situation situation() const;
  void publish(const Decision& decision);

  node::Context& context_;
  Params params_;
  node::SensorInput input_;
  std::optional<Geofence> geofence_;
  Navigator navigator_;
  Display display_;
  SlipMonitor slip_;
  std::int64_t num_slips_ = 0;

  node::SequenceCounter pitch_commands_watch_;
  InputSenders senders_;
  node::SequenceCounter pitch_states_watch_;
  InputStamps stamps_;
  time::Timestamp odometry_frame_began_{};
  std::optional<ObstacleMap> map_;
  std::optional<Odometry> odometry_;
  geometry::PoseHistory odometry_history_{1s};
  scan::Scan scan_;  // reused from message to message
  nodmap::pitch_command_t pitch_command_{};
  nodmap::pitch_state_t pitch_state_{};
  std::optional<GoalInMap> goal_;
  std::optional<std::string> stopped_by_;
  geometry::SE2 T_map_odom_;
  std::int8_t pose_state_ = nodmap::pose_t::TRACKING;  // of the last POSE_2D
  double pose_sigma_m_ = 0.0;                          // in its worst direction
  std::optional<time::Timestamp> pose_stamp_;          // by odometry, when it was used

  nodmap::drive_t drive_{};
  nodmap::navigation_t navigation_{};
  std::int64_t next_drive_seq_ = 0;
  std::array<std::int64_t, 5> decisions_{};                                   // by behaviour
  std::optional<Reason> inhibit_reason_ = Reason(Why::kNoInput, "odometry");  // of the last one
};

}  // namespace nodmap::navigator
