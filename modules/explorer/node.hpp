// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "common/node/goal_sender.hpp"
#include "common/node/map_2d_input.hpp"
#include "common/node/node.hpp"
#include "common/node/sensor_input.hpp"
#include "common/node/stop_latch.hpp"
#include "modules/explorer/explorer.hpp"
#include "nodmap/exploration_t.hpp"
#include "nodmap/explore_t.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/odometry_t.hpp"
#include "nodmap/path_t.hpp"
#include "nodmap/pose_t.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::explorer {

/// Runs the explorer twice a second, and when the navigator arrives, on MAP_2D, POSE_2D, ODOMETRY,
/// NAVIGATION and PATH. Publishes EXPLORATION as often, also while nothing can be decided, and GOAL
/// when it changes and once a second. EXPLORE starts and ends it, a GOAL of another sender ends it,
/// and during a STOP it waits.
class ExplorerNode final : public node::Node {
 public:
  using Params = ExplorerParams;

  ExplorerNode(node::Context& context, const Params& params);

  void write_results(const std::filesystem::path& /*dir*/) override {}
  [[nodiscard]] nlohmann::json metrics() const override;
  [[nodiscard]] node::Health health() const override;

 private:
  /// After the exploration the robot's own position becomes its goal: without a goal it would roam.
  enum class StayAfterEnd : std::uint8_t {
    kNone,     // it is exploring, or somebody else has set a goal
    kPending,  // its next position becomes the goal
    kSent,     // the goal is where it was then
  };

  void on_map(const nodmap::grid_chunk_t& message);
  void begin_new_map();
  void on_pose(const nodmap::pose_t& message);
  void on_odometry(const nodmap::odometry_t& message);
  void on_navigation(const nodmap::navigation_t& message);
  void on_path(const nodmap::path_t& message);
  void on_explore(const nodmap::explore_t& message);
  void on_goal(const nodmap::goal_t& message);
  void on_stop(const nodmap::stop_t& message);

  [[nodiscard]] bool explores() const;
  void start();
  void end(const std::string& reason);
  /// Sends the robot's present position as the goal.
  void keep_place(time::Timestamp now);
  void repeat_goal(time::Timestamp now);
  void decide(time::Timestamp now);
  [[nodiscard]] Decision next_decision(time::Timestamp now);
  /// Where the robot is, as far as is known: by the newest odometry and the last pose, however old
  /// that is.
  [[nodiscard]] std::optional<geometry::SE2> T_map_base() const;
  void send_goal(const Goal& goal, time::Timestamp now);
  /// Why it is not known where the robot is; empty if it is known.
  [[nodiscard]] std::string pose_fault(time::Timestamp now) const;
  /// Why the robot may not drive; empty if it may.
  [[nodiscard]] std::string halt_reason(time::Timestamp now) const;
  /// Publishes the state without a decision.
  void publish_state(const std::string& reason, time::Timestamp now);
  void publish(const Decision& decision, time::Timestamp now);

  node::Context& context_;
  Params params_;
  node::SensorInput input_;
  node::Map2dInput map_input_;
  Explorer explorer_;

  std::optional<geometry::SE2> T_map_odom_;
  std::optional<time::Timestamp> posed_;  // stamp of the last pose
  std::optional<geometry::SE2> T_odom_base_;
  std::optional<time::Timestamp> odometry_at_;  // stamp of the last odometry
  bool is_lost_ = false;
  node::StopLatch stop_latch_;
  std::optional<time::Timestamp> no_path_at_;    // when the navigator last said so
  std::optional<time::Timestamp> navigated_at_;  // stamp of the last NAVIGATION
  std::optional<std::string> navigator_halt_;    // why by that message the robot may not drive
  std::optional<time::Timestamp> halted_since_;  // when it began to keep the exploration waiting
  std::string halt_reason_;                      // also: why nothing can be decided
  bool has_arrived_ = false;
  bool has_just_arrived_ = false;  // since the last decision
  std::string idle_reason_ = "Waiting to be started.";
  StayAfterEnd stay_ = StayAfterEnd::kNone;

  std::optional<time::Timestamp> decided_;
  node::GoalSender goal_sender_;
  std::optional<Goal> goal_;  // the last one since the start, in the present map
  std::optional<std::int64_t> others_goal_utime_;  // of the last GOAL of another sender
  std::int64_t num_decisions_ = 0;
  double seen_m2_ = 0.0;
};

}  // namespace nodmap::explorer
