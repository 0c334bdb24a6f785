// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/node.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/node/goal_sender.hpp"
#include "common/node/messages.hpp"
#include "common/robot/robot_params.hpp"
#include "common/scan/ego_map_points.hpp"
#include "modules/navigator/inputs/inhibit_reason.hpp"

namespace nodmap::navigator {
namespace {

using Input = InputSenders::Input;

// POSE_2D comes at least once a second. One that was measured longer ago says where the robot was.
constexpr time::Duration kMaxPoseAge = 5s;

// No sweep is shorter: 15 scans. A gap in the scans no longer than this is driven through slowly.
constexpr double kShortGapS = 0.2;

}  // namespace

NavigatorNode::NavigatorNode(node::Context& context, const Params& params)
    : context_(context),
      params_(params),
      input_(context.counts, &context.bus),
      map_input_(context.counts, context.bus),
      navigator_(params),
      display_(context.bus) {
  if (!params.geofence.empty()) {
    newest_.geofence = &geofence_.emplace(params.geofence);
  }
  newest_.map_2d = params.planner.use_map ? &map_2d_ : nullptr;
  bus::Bus& bus = context.bus;
  bus.subscribe<nodmap::scan_t>("SCAN", [this](const auto& m) { on_scan(m); });
  bus.subscribe<nodmap::egomap_t>("OBSTACLE_MAP", [this](const auto& m) { on_map(m); });
  bus.subscribe<nodmap::odometry_t>("ODOMETRY", [this](const auto& m) { on_odometry(m); });
  bus.subscribe<nodmap::base_sensors_t>("BASE_SENSORS",
                                        [this](const auto& m) { on_base_sensors(m); });
  bus.subscribe<nodmap::pitch_command_t>("PITCH_COMMAND",
                                         [this](const auto& m) { on_pitch_command(m); });
  bus.subscribe<nodmap::pitch_state_t>("PITCH_STATE", [this](const auto& m) { on_pitch_state(m); });
  bus.subscribe<nodmap::goal_t>("GOAL", [this](const auto& m) { on_goal(m); });
  bus.subscribe<nodmap::pose_t>("POSE_2D", [this](const auto& m) { on_pose(m); });
  if (params.planner.use_map) {
    bus.subscribe<nodmap::grid_chunk_t>("MAP_2D", [this](const auto& m) { on_map_tile(m); });
  }
  bus.subscribe<nodmap::stop_t>("STOP", [this](const auto& m) { on_stop(m); });
}

// Follows the sender of the message being handled. Counts the message and returns false if another
// one is followed.
bool NavigatorNode::follow_sender(InputSenders::Input input) {
  if (senders_.follow(input, context_.bus.origin())) {
    return true;
  }
  context_.counts.reject(InputSenders::cause_of(input));
  return false;
}

void NavigatorNode::on_map(const nodmap::egomap_t& message) {
  const auto T_odom_map = node::read_pose(message.position_m, message.orientation);
  auto points_map =
      scan::read_ego_map_points(message.distance_m, message.point_x_m, message.point_y_m);
  if (!T_odom_map || !points_map || !time::is_plausible(node::stamp_of(message))) {
    context_.counts.reject("implausible_obstacle_map");
    return;
  }
  if (node::stamp_of(message) < odometry_frame_began_) {
    context_.counts.reject("map_of_former_odometry");
    return;
  }
  if (!follow_sender(Input::kObstacleMap)) {
    return;
  }
  context_.counts.use();
  newest_.map = {geometry::to_se2(*T_odom_map), std::move(*points_map)};
  newest_.stamps.map = node::stamp_of(message);
  auto reason = find_inhibit_reason(params_.staleness);
  publish(reason ? halt(std::move(*reason)) : navigator_.decide(newest_.situation(params_.drive)));
}

void NavigatorNode::on_scan(const nodmap::scan_t& message) {
  if (!input_.read(message, scan_)) {
    senders_.refuse(Input::kScan, context_.bus.origin());
    return;
  }
  const auto T_odom_base = odometry_history_.at(scan_.mid_stamp());
  if (!T_odom_base) {
    context_.counts.reject("scan_without_odometry");
    return;
  }
  if (!follow_sender(Input::kScan)) {
    return;
  }
  context_.counts.use();
  newest_.stamps.scan = scan_.mid_stamp();
  navigator_.add_scan(scan_, geometry::to_se2(*T_odom_base), newest_.laser_is_held);
  if (!may_notice_slip()) {
    scan_slip_.reset();
  } else if (const auto before = scan_slip_.update(scan_, geometry::to_se2(*T_odom_base))) {
    leave_contact(*before);
  }
}

// Not every base has range finders. Without them nobody who comes from behind is noticed.
void NavigatorNode::on_base_sensors(const nodmap::base_sensors_t& message) {
  const time::Timestamp stamp = node::stamp_of(message);
  const auto T_odom_base = odometry_history_.at(stamp);
  if (!T_odom_base) {
    context_.counts.reject("base_sensors_without_odometry");
    return;
  }
  if (!follow_sender(Input::kBaseSensors)) {
    return;
  }
  if (*newest_.stamps.odometry - stamp > kMaxBaseSensorsAge) {
    context_.counts.reject("stale_base_sensors");
    return;
  }
  context_.counts.use();
  navigator_.add_ranges(stamp, ranges_of(message), geometry::to_se2(*T_odom_base));
}

void NavigatorNode::on_odometry(const nodmap::odometry_t& message) {
  const auto T_odom_base = input_.read(message);
  odom_frame_is_new_ = odom_frame_is_new_ || (T_odom_base && input_.odometry_restarted());
  if (!T_odom_base) {
    senders_.refuse(Input::kOdometry, context_.bus.origin());
    return;
  }
  if (!follow_sender(Input::kOdometry)) {
    return;
  }
  if (std::exchange(odom_frame_is_new_, false)) {
    begin_odometry_frame(node::stamp_of(message));
  }
  // The frame began no later than any of its odometry: an earlier stamp means that the first one
  // was wrong, or that the clock has been set back since.
  odometry_frame_began_ = std::min(odometry_frame_began_, node::stamp_of(message));
  context_.counts.use();
  newest_.odometry = {message.odometry_seq, geometry::to_se2(*T_odom_base), message.forward_mps,
                      message.yaw_rate_rad_s};
  newest_.stamps.odometry = node::stamp_of(message);
  odometry_history_.add(node::stamp_of(message), *T_odom_base);
  if (auto reason = find_inhibit_reason(params_.staleness)) {
    publish(halt(std::move(*reason)));
  }
}

// The publisher counts from the start again, so its odom frame is a new one. The map, the
// navigator's memory and the correction to the map frame belong to the old one.
void NavigatorNode::begin_odometry_frame(time::Timestamp stamp) {
  odometry_frame_began_ = stamp;
  newest_.forget_odom_frame();
  odometry_history_.clear();
  slip_.reset();
  scan_slip_.reset();
  navigator_.reset();
}

void NavigatorNode::on_pitch_command(const nodmap::pitch_command_t& message) {
  if (!is_plausible(message)) {
    context_.counts.reject("implausible_pitch_command");
    return;
  }
  if (!follow_sender(Input::kPitchCommand)) {
    return;
  }
  context_.counts.lose(pitch_commands_watch_.lost_before(message.command_seq));
  context_.counts.use();
  newest_.max_forward_mps = message.max_forward_mps;
  newest_.laser_is_held = message.pitch_max_rad - message.pitch_min_rad < robot::kHeldRad;
  newest_.stamps.pitch_command = node::stamp_of(message);
}

void NavigatorNode::on_pitch_state(const nodmap::pitch_state_t& message) {
  if (!node::is_plausible(message)) {
    context_.counts.reject("implausible_pitch_state");
    return;
  }
  if (!follow_sender(Input::kPitchState)) {
    return;
  }
  context_.counts.lose(pitch_states_watch_.lost_before(message.state_seq));
  context_.counts.use();
  const bool has_stalled = message.is_stalled != 0 && !newest_.servo_is_stalled;
  newest_.sweep_count = message.sweep_count;
  newest_.servo_is_stalled = message.is_stalled != 0;
  newest_.stamps.pitch_state = node::stamp_of(message);
  // At once: until the next map or odometry a fast robot would drive another 2 cm.
  if (auto reason = has_stalled ? find_inhibit_reason(params_.staleness) : std::nullopt) {
    publish(halt(std::move(*reason)));
  }
}

void NavigatorNode::on_goal(const nodmap::goal_t& message) {
  if (!is_plausible(message)) {
    context_.counts.reject("implausible_goal");
    return;
  }
  if (message.is_active != 0 && message.tolerance_m > node::kMaxGoalToleranceM) {
    context_.counts.reject("goal_tolerance_above_10_m");
    return;
  }
  context_.counts.use();
  newest_.take_goal(read_goal(message));
}

// Moves the goal in odom. A stale or missing pose is no reason to halt: it leads the robot to
// another place, but not into an obstacle. With a pose that is LOST the goal could be anywhere, so
// a robot on the way to one halts.
void NavigatorNode::on_pose(const nodmap::pose_t& message) {
  const time::Timestamp stamp = node::stamp_of(message);
  const auto T_map_odom = node::read_pose(message.odom_position_m, message.odom_orientation);
  if (const char* cause = T_map_odom ? fault_of_pose_stamp(stamp) : "implausible_pose") {
    slip_.reset();
    context_.counts.reject(cause);
    return;
  }
  if (map_input_.follow_pose()) {
    newest_.forget_map_frame();
    map_2d_.clear();
    navigator_.forget_map();
  }
  newest_.pose.is_degraded = message.state == nodmap::pose_t::DEGRADED;
  newest_.pose.is_lost = message.state == nodmap::pose_t::LOST;
  if (newest_.pose.is_lost) {
    slip_.reset();
    context_.counts.reject("lost_pose");
    return;
  }
  context_.counts.use();
  // What was known before the first pose is where odometry began, not where the robot was found in
  // a saved map. A later jump corrects odometry, such as wheels that slipped: the map is the same.
  const bool is_first = !newest_.pose.stamp;
  if (newest_.correct_pose(geometry::to_se2(*T_map_odom)) && is_first) {
    navigator_.forget_map();
  }
  newest_.pose.sigma_m = position_sigma_m(message);
  if (newest_.stamps.odometry) {
    newest_.pose.stamp = stamp;
  }
  watch_slip(message);
}

// Why a pose with this stamp counts as none; null if it does not.
const char* NavigatorNode::fault_of_pose_stamp(time::Timestamp stamp) const {
  if (!time::is_plausible(stamp)) {
    return "implausible_pose";
  }
  if (stamp < odometry_frame_began_) {
    return "pose_of_former_odometry";
  }
  const time::Duration age = newest_.stamps.odometry.value_or(stamp) - stamp;
  if (age > kMaxPoseAge) {
    return "stale_pose";
  }
  return time::seconds(age) < -params_.staleness.odometry_s ? "pose_from_future" : nullptr;
}

// The 2D map changes the plan, and nothing that keeps the robot from hitting something.
void NavigatorNode::on_map_tile(const nodmap::grid_chunk_t& message) {
  const auto read = map_input_.read(message);
  if (!read) {
    return;
  }
  if (read->begins_map) {
    map_2d_.clear();
  }
  if (!map_2d_.add(read->tile)) {
    context_.counts.reject("map_tile_of_unusable_size");
    return;
  }
  context_.counts.use();
}

// Only while 2D SLAM is sure in all directions: along a bare corridor it follows the wheels.
void NavigatorNode::watch_slip(const nodmap::pose_t& message) {
  const auto T_odom_base = odometry_history_.at(node::stamp_of(message));
  if (message.state != nodmap::pose_t::TRACKING || !T_odom_base || !may_notice_slip()) {
    slip_.reset();
    return;
  }
  const geometry::SE2 T_odom_base_2d = geometry::to_se2(*T_odom_base);
  if (const auto before = slip_.update(node::stamp_of(message), T_odom_base_2d,
                                       newest_.pose.T_map_odom * T_odom_base_2d)) {
    leave_contact(*before);
  }
}

// On slopes scans meet the floor, and may not show that the robot moves. What it touches beside
// people may be one of them, who goes on alone; to begin anew would forget where they all are.
bool NavigatorNode::may_notice_slip() const {
  constexpr double kNearM = 2.0;  // a second of brisk walking, and both bodies
  const LocalMap& map = navigator_.local_map();
  return map.has_scan() && map.ground().is_level() && !navigator_.is_stopping_at_contact() &&
         !navigator_.people().is_anybody_near(newest_.odometry->T_odom_base.translation(), kNearM,
                                              scan_.mid_stamp());
}

void NavigatorNode::leave_contact(const geometry::SE2& T_odom_before) {
  ++num_slips_;
  slip_.reset();
  scan_slip_.reset();
  navigator_.leave_contact(*newest_.stamps.odometry, T_odom_before, newest_.odometry->T_odom_base);
}

// Remains in force until a message releases it, even if the sender has ended.
void NavigatorNode::on_stop(const nodmap::stop_t& message) {
  context_.counts.use();
  newest_.is_fence_void = newest_.is_fence_void && !stop_latch_.is_new_release(message);
  stop_latch_.take(message);
  newest_.stopped_by = stop_latch_.stopped_by();
}

// If a short gap in the scans is the only reason, the navigator keeps what it has seen.
Decision NavigatorNode::halt(Reason reason) {
  StalenessParams limits = params_.staleness;
  limits.map_s = std::max(limits.map_s, kShortGapS);
  const bool is_short_gap = !find_inhibit_reason(limits);
  return is_short_gap ? navigator_.pause(std::move(reason)) : navigator_.halt(std::move(reason));
}

std::optional<Reason> NavigatorNode::find_inhibit_reason(const StalenessParams& limits) const {
  return inhibit_reason(newest_, senders_.contested_channel(context_.bus.origin().arrived), params_,
                        limits);
}

void NavigatorNode::publish(const Decision& decision) {
  // Odometry comes from the host of the base driver: its stamps are the driver's own clock.
  drive_.utime = time::to_utime(
      newest_.stamps.odometry.value_or(newest_.stamps.map.value_or(time::Timestamp{})));
  drive_.drive_seq = next_drive_seq_++;
  drive_.forward_mps = decision.forward_mps;
  drive_.yaw_rate_rad_s = decision.yaw_rate_rad_s;
  drive_.valid_us = time::to_us(time::from_seconds(params_.drive_valid_s));
  context_.bus.publish("DRIVE", drive_);

  navigation_.utime = drive_.utime;
  navigation_.drive_seq = drive_.drive_seq;
  navigation_.goal_utime = newest_.goal_utime();
  navigation_.behaviour = code_of(decision.behaviour);
  navigation_.reason = to_text(decision.reason);
  navigation_.steering_angle_rad = decision.steering_angle_rad;
  navigation_.corridor_length_m =
      params_.robot.braking.required_distance_m(decision.max_forward_mps, params_.drive.reaction_s);
  navigation_.corridor_width_m = params_.robot.body.width_m + 2.0 * params_.drive.side_margin_m;
  navigation_.clear_distance_m = decision.free_distance_m;
  navigation_.max_forward_mps = decision.max_forward_mps;
  context_.bus.publish("NAVIGATION", navigation_);

  if (newest_.odometry) {
    display_.publish(time::from_utime(drive_.utime), navigator_, decision, newest_);
  }
  ++decisions_[static_cast<std::size_t>(decision.behaviour)];
  inhibit_reason_.reset();
  if (decision.behaviour == Behaviour::kHalt) {
    inhibit_reason_ = decision.reason;
  }
}

nlohmann::json NavigatorNode::metrics() const {
  return {{"decisions",
           {{"steer", decisions_[nodmap::navigation_t::STEER]},
            {"brake", decisions_[nodmap::navigation_t::BRAKE]},
            {"turn", decisions_[nodmap::navigation_t::TURN]},
            {"arrived", decisions_[nodmap::navigation_t::ARRIVED]},
            {"halt", decisions_[nodmap::navigation_t::HALT]}}},
          {"slips", num_slips_}};
}

node::Health NavigatorNode::health() const {
  if (inhibit_reason_) {
    return {node::HealthState::kDegraded, "The robot halts: " + to_text(*inhibit_reason_)};
  }
  return {};
}

}  // namespace nodmap::navigator
