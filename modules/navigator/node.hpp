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
#include "common/node/map_2d_input.hpp"
#include "common/node/node.hpp"
#include "common/node/sensor_input.hpp"
#include "common/node/stop_latch.hpp"
#include "modules/navigator/contact/scan_slip.hpp"
#include "modules/navigator/contact/slip.hpp"
#include "modules/navigator/display.hpp"
#include "modules/navigator/geofence.hpp"
#include "modules/navigator/inputs/inputs.hpp"
#include "modules/navigator/inputs/senders.hpp"
#include "modules/navigator/inputs/staleness.hpp"
#include "modules/navigator/messages.hpp"
#include "modules/navigator/navigator.hpp"
#include "modules/navigator/planner/map_2d.hpp"
#include "nodmap/base_sensors_t.hpp"
#include "nodmap/drive_t.hpp"
#include "nodmap/egomap_t.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/pitch_command_t.hpp"
#include "nodmap/pitch_state_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/scan_t.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::navigator {

/// Runs the navigator: README.md lists the channels. Publishes one DRIVE and one NAVIGATION for
/// each obstacle map and, while the robot halts, for each ODOMETRY.
class NavigatorNode final : public node::Node {
 public:
  using Params = NavigatorParams;

  NavigatorNode(node::Context& context, const Params& params);

  void write_results(const std::filesystem::path& /*dir*/) override {}
  [[nodiscard]] nlohmann::json metrics() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  void on_map(const nodmap::egomap_t& message);
  void on_scan(const nodmap::scan_t& message);
  void on_base_sensors(const nodmap::base_sensors_t& message);
  void on_odometry(const nodmap::odometry_t& message);
  void on_pitch_command(const nodmap::pitch_command_t& message);
  void on_pitch_state(const nodmap::pitch_state_t& message);
  void on_goal(const nodmap::goal_t& message);
  void on_pose(const nodmap::pose_t& message);
  void on_map_tile(const nodmap::grid_chunk_t& message);
  void on_stop(const nodmap::stop_t& message);

  [[nodiscard]] bool follow_sender(InputSenders::Input input);
  [[nodiscard]] const char* fault_of_pose_stamp(time::Timestamp stamp) const;
  void watch_slip(const nodmap::pose_t& message);
  [[nodiscard]] bool may_notice_slip() const;
  void leave_contact(const geometry::SE2& T_odom_before);
  void begin_odometry_frame(time::Timestamp stamp);
  [[nodiscard]] Decision halt(Reason reason);
  [[nodiscard]] std::optional<Reason> find_inhibit_reason(const StalenessParams& limits) const;
  void publish(const Decision& decision);

  node::Context& context_;
  Params params_;
  node::SensorInput input_;
  node::Map2dInput map_input_;
  node::StopLatch stop_latch_;
  std::optional<Geofence> geofence_;
  Map2d map_2d_;
  Inputs newest_;
  Navigator navigator_;
  Display display_;
  SlipMonitor slip_;
  ScanSlip scan_slip_;
  std::int64_t num_slips_ = 0;

  node::SequenceCounter pitch_commands_watch_;
  InputSenders senders_;
  node::SequenceCounter pitch_states_watch_;
  time::Timestamp odometry_frame_began_{};
  bool odom_frame_is_new_ = false;  // since the odometry used last
  geometry::PoseHistory odometry_history_{1s};
  scan::Scan scan_;  // reused from message to message

  nodmap::drive_t drive_{};
  nodmap::navigation_t navigation_{};
  std::int64_t next_drive_seq_ = 0;
  std::array<std::int64_t, 5> decisions_{};  // by navigation_t's number of the behaviour
  std::optional<Reason> inhibit_reason_ = Reason(Why::kNoInput, "odometry");
};

}  // namespace nodmap::navigator
