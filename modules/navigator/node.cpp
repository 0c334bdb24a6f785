// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/node.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/node/messages.hpp"

namespace nodmap::navigator {
namespace {

using Input = InputSenders::Input;

// A microsecond clock gets there in the year 38000; differences of stamps below never overflow.
constexpr time::Timestamp kLatestStamp(time::kLimit / 2);
/// A laser whose sweeps are shorter than this is held.
constexpr double kHeldRad = geometry::deg_to_rad(0.1);
/// The base cannot drive faster; a map farther away than that belongs to another odom frame.
constexpr double kTopSpeedMps = 5.2;

/// Of the fastest speed, while the pose is DEGRADED and the goal may be this near.
constexpr double kDegradedSpeedRatio = 0.5;
constexpr double kGoalSigmas = 3.0;

/// POSE_2D comes once a sweep, which takes up to 1 s. A pose older than this is stale: by odometry
/// alone, at 1.5 m/s and with wheels 3 % off, the robot is 9 cm elsewhere by then.
constexpr time::Duration kFencePose = 2s;

/// No sweep is shorter: 15 scans. A gap in the scans no longer than this is driven through slowly.
constexpr double kShortGapS = 0.2;

bool is_time(time::Timestamp stamp) {
  return stamp >= time::Timestamp{} && stamp < kLatestStamp;
}

}  // namespace

NavigatorNode::NavigatorNode(node::Context& context, const Params& params)
    : context_(context),
      params_(params),
      input_(context.counts),
      navigator_(params),
      display_(context.bus) {
  if (!params.geofence.empty()) {
    geofence_.emplace(params.geofence);
  }
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
  bus.subscribe<nodmap::stop_t>("STOP", [this](const auto& m) { on_stop(m); });
}

void NavigatorNode::on_map(const nodmap::egomap_t& message) {
  const auto T_odom_map = node::read_pose(message.position_m, message.orientation);
  auto points_map = read_points(message.distance_m, message.point_x_m, message.point_y_m);
  if (!T_odom_map || !points_map || !is_time(node::stamp_of(message))) {
    context_.counts.reject("implausible_obstacle_map");
    return;
  }
  if (node::stamp_of(message) < odometry_frame_began_) {
    context_.counts.reject("map_of_former_odometry");
    return;
  }
  context_.counts.use();
  map_ = {geometry::to_se2(*T_odom_map), std::move(*points_map)};
  stamps_.map = node::stamp_of(message);
  auto reason = reason_not_to_drive(params_.staleness);
  publish(reason ? halt(std::move(*reason)) : navigator_.decide(situation()));
}

void NavigatorNode::on_scan(const nodmap::scan_t& message) {
  if (!input_.read(message, scan_)) {
    return;
  }
  const auto T_odom_base = odometry_history_.at(scan_.mid_stamp());
  if (!T_odom_base) {
    context_.counts.reject("scan_without_odometry");
    return;
  }
  if (!senders_.follow(Input::kScan, message.scan_seq, node::stamp_of(message), stamps_)) {
    context_.counts.reject("other_sender_of_scan");
    return;
  }
  context_.counts.use();
  stamps_.scan = scan_.mid_stamp();
  navigator_.add_scan(scan_, geometry::to_se2(*T_odom_base), laser_is_held());
}

/// Not every base has range finders. Without them nobody who comes from behind is noticed.
void NavigatorNode::on_base_sensors(const nodmap::base_sensors_t& message) {
  const auto T_odom_base = odometry_history_.at(node::stamp_of(message));
  if (!T_odom_base) {
    context_.counts.reject("base_sensors_without_odometry");
    return;
  }
  context_.counts.use();
  Proximity::Ranges ranges_m;
  std::ranges::copy(message.infrared_m, ranges_m.begin());
  navigator_.add_ranges(node::stamp_of(message), ranges_m, geometry::to_se2(*T_odom_base));
}

void NavigatorNode::on_odometry(const nodmap::odometry_t& message) {
  const auto T_odom_base = input_.read(message);
  if (!T_odom_base) {
    return;
  }
  if (!std::isfinite(message.forward_mps) || !std::isfinite(message.yaw_rate_rad_s)) {
    context_.counts.reject("implausible_odometry");
    return;
  }
  if (!senders_.follow(Input::kOdometry, message.odometry_seq, node::stamp_of(message), stamps_)) {
    context_.counts.reject("other_sender_of_odometry");
    return;
  }
  if (odometry_ && message.odometry_seq < odometry_->seq) {
    begin_odometry_frame(node::stamp_of(message));
  }
  // The frame began no later than any of its odometry: an earlier stamp means that the first one
  // was wrong, or that the clock has been set back since.
  odometry_frame_began_ = std::min(odometry_frame_began_, node::stamp_of(message));
  context_.counts.use();
  odometry_ = {message.odometry_seq, geometry::to_se2(*T_odom_base), message.forward_mps,
               message.yaw_rate_rad_s};
  stamps_.odometry = node::stamp_of(message);
  odometry_history_.add(node::stamp_of(message), *T_odom_base);
  if (auto reason = reason_not_to_drive(params_.staleness)) {
    publish(halt(std::move(*reason)));
  }
}

/// The publisher counts from the start again, so its odom frame is a new one. The map, the
/// navigator's memory and the correction to the map frame belong to the old one.
void NavigatorNode::begin_odometry_frame(time::Timestamp stamp) {
  odometry_frame_began_ = stamp;
  map_.reset();
  odometry_history_.clear();
  slip_.reset();
  pose_stamp_.reset();
  stamps_.map.reset();
  stamps_.scan.reset();
  navigator_.reset();
}

void NavigatorNode::on_pitch_command(const nodmap::pitch_command_t& message) {
  context_.counts.lose(pitch_commands_watch_.lost_before(message.command_seq));
  if (!is_time(node::stamp_of(message)) || !std::isfinite(message.max_forward_mps) ||
      message.max_forward_mps < 0.0) {
    context_.counts.reject("implausible_pitch_command");
    return;
  }
  if (!senders_.follow(Input::kPitchCommand, message.command_seq, node::stamp_of(message),
                       stamps_)) {
    context_.counts.reject("other_sender_of_pitch_command");
    return;
  }
  context_.counts.use();
  pitch_command_ = message;
  stamps_.pitch_command = node::stamp_of(message);
}

void NavigatorNode::on_pitch_state(const nodmap::pitch_state_t& message) {
  context_.counts.lose(pitch_states_watch_.lost_before(message.state_seq));
  if (!is_time(node::stamp_of(message))) {
    context_.counts.reject("implausible_pitch_state");
    return;
  }
  if (!senders_.follow(Input::kPitchState, message.state_seq, node::stamp_of(message), stamps_)) {
    context_.counts.reject("other_sender_of_pitch_state");
    return;
  }
  context_.counts.use();
  pitch_state_ = message;
  stamps_.pitch_state = node::stamp_of(message);
}

void NavigatorNode::on_goal(const nodmap::goal_t& message) {
  if (!is_plausible(message)) {
    context_.counts.reject("implausible_goal");
    return;
  }
  context_.counts.use();
  goal_ = read_goal(message);
}

/// Moves the goal in odom. A stale or missing pose is no reason to halt: it leads the robot to
/// another place, but not into an obstacle. With a pose that is LOST the goal could be anywhere, so
/// a robot on the way to one halts.
void NavigatorNode::on_pose(const nodmap::pose_t& message) {
  const auto T_map_odom = node::read_pose(message.odom_position_m, message.odom_orientation);
  if (T_map_odom) {
    pose_state_ = message.state;
  }
  if (!T_map_odom || message.state == nodmap::pose_t::LOST) {
    context_.counts.reject(T_map_odom ? "lost_pose" : "implausible_pose");
    return;
  }
  context_.counts.use();
  T_map_odom_ = geometry::to_se2(*T_map_odom);
  pose_sigma_m_ = position_sigma_m(message);
  pose_stamp_ = stamps_.odometry;
  watch_slip(message);
}

/// Only while 2D SLAM is sure in all directions: along a bare corridor it follows the wheels.
void NavigatorNode::watch_slip(const nodmap::pose_t& message) {
  const auto T_odom_base = odometry_history_.at(node::stamp_of(message));
  if (message.state != nodmap::pose_t::TRACKING || !T_odom_base) {
    slip_.reset();
    return;
  }
  const geometry::SE2 T_odom_base_2d = geometry::to_se2(*T_odom_base);
  if (slip_.update(node::stamp_of(message), T_odom_base_2d, T_map_odom_ * T_odom_base_2d)) {
    ++num_slips_;
    navigator_.add_contact(T_odom_base_2d, odometry_->forward_mps >= 0.0);
  }
}

/// Remains in force until a message releases it, even if the sender has ended.
void NavigatorNode::on_stop(const nodmap::stop_t& message) {
  context_.counts.use();
  stopped_by_.reset();
  if (message.is_stopped != 0) {
    stopped_by_ = message.requested_by;
  }
}

/// If a short gap in the scans is the only reason, the navigator keeps what it has seen.
Decision NavigatorNode::halt(Reason reason) {
  StalenessParams limits = params_.staleness;
  limits.map_s = std::max(limits.map_s, kShortGapS);
  return reason_not_to_drive(limits) ? navigator_.halt(std::move(reason))
                                     : navigator_.pause(std::move(reason));
}

std::optional<Reason> NavigatorNode::reason_not_to_drive(const StalenessParams& limits) const {
  if (stopped_by_) {
    return Reason(Why::kStopped, *stopped_by_);
  }
  if (goal_ && pose_state_ == nodmap::pose_t::LOST) {
    return Why::kLostPose;
  }
  if (auto stale = reason_to_halt(stamps_, limits, params_.local_map.use)) {
    return stale;
  }
  if (auto channel = senders_.contested_channel(stamps_)) {
    return Reason(Why::kTwoSenders, std::move(*channel));
  }
  if (pitch_state_.is_stalled != 0) {
    return Why::kStalledServo;
  }
  if (auto reason = reason_by_geofence()) {
    return reason;
  }
  if (goal_ && goal_->heading_tolerance_rad && !(params_.planner.use && params_.local_map.use)) {
    return Why::kDocksByPlanOnly;
  }
  const double age_s = time::seconds(std::chrono::abs(*stamps_.odometry - *stamps_.map));
  const double shift_m =
      (odometry_->T_odom_base.translation() - map_->T_odom_map.translation()).norm();
  // 10 cm because the map's pose is interpolated.
  if (shift_m > kTopSpeedMps * age_s + 0.1) {
    return Why::kMapMisfit;
  }
  return std::nullopt;
}

/// With a geofence the robot drives only while it knows that it is inside. If it has got outside,
/// it does not drive back: nothing says that the path back is allowed.
std::optional<Reason> NavigatorNode::reason_by_geofence() const {
  if (!geofence_) {
    return std::nullopt;
  }
  if (!pose_stamp_ || pose_state_ == nodmap::pose_t::LOST ||
      std::chrono::abs(*stamps_.odometry - *pose_stamp_) > kFencePose) {
    return Why::kNoPoseInFence;
  }
  if (!geofence_->contains(T_map_odom_ * odometry_->T_odom_base.translation())) {
    return Why::kOutsideFence;
  }
  if (goal_state() == GoalState::kOutsideFence) {
    return Why::kGoalOutsideFence;
  }
  return std::nullopt;
}

GoalState NavigatorNode::goal_state() const {
  if (!goal_) {
    return GoalState::kNone;
  }
  const bool is_inside = !geofence_ || geofence_->contains(goal_->T_map_goal.translation());
  return is_inside ? GoalState::kInside : GoalState::kOutsideFence;
}

Situation NavigatorNode::situation() const {
  Situation now;
  now.stamp = *stamps_.odometry;
  now.T_odom_base = odometry_->T_odom_base;
  now.T_map_odom = T_map_odom_;
  now.points_base = move_to_base(map_->points_map, map_->T_odom_map, odometry_->T_odom_base);
  now.forward_mps = odometry_->forward_mps;
  now.yaw_rate_rad_s = odometry_->yaw_rate_rad_s;
  now.max_forward_mps = max_forward_mps();
  now.sweep_count = pitch_state_.sweep_count;
  now.geofence = geofence_ ? &*geofence_ : nullptr;
  now.laser_is_held = laser_is_held();
  if (goal_) {
    const geometry::SE2 T_base_goal =
        (T_map_odom_ * odometry_->T_odom_base).inverse() * goal_->T_map_goal;
    now.goal = goal_in_base(T_base_goal.translation(), goal_->tolerance_m);
    if (goal_->heading_tolerance_rad) {
      now.goal->heading = {T_base_goal.yaw, *goal_->heading_tolerance_rad};
    }
  }
  return now;
}

bool NavigatorNode::laser_is_held() const {
  return stamps_.pitch_command &&
         pitch_command_.pitch_max_rad - pitch_command_.pitch_min_rad < kHeldRad;
}

/// Whether the goal may be this near, if the pose follows odometry in some or all directions, as
/// along a bare corridor. Farther from the goal this error is no reason to be slow: obstacles are
/// measured, whatever the pose.
bool NavigatorNode::may_be_at_goal() const {
  const Eigen::Vector2d p_map = T_map_odom_ * odometry_->T_odom_base.translation();
  return (goal_->T_map_goal.translation() - p_map).norm() <
         goal_->tolerance_m + kGoalSigmas * pose_sigma_m_;
}

double NavigatorNode::max_forward_mps() const {
  if (goal_ && pose_state_ == nodmap::pose_t::DEGRADED && may_be_at_goal()) {
    return std::min(pitch_command_.max_forward_mps,
                    kDegradedSpeedRatio * params_.drive.max_forward_mps);
  }
  return pitch_command_.max_forward_mps;
}

void NavigatorNode::publish(const Decision& decision) {
  // Odometry comes from the host of the base driver: its stamps are the driver's own clock.
  drive_.utime = time::to_utime(stamps_.odometry.value_or(stamps_.map.value_or(time::Timestamp{})));
  drive_.drive_seq = next_drive_seq_++;
  drive_.forward_mps = decision.forward_mps;
  drive_.yaw_rate_rad_s = decision.yaw_rate_rad_s;
  drive_.valid_us = time::to_us(time::from_seconds(params_.drive_valid_s));
  context_.bus.publish("DRIVE", drive_);

  navigation_.utime = drive_.utime;
  navigation_.drive_seq = drive_.drive_seq;
  navigation_.behaviour = code_of(decision.behaviour);
  navigation_.reason = to_text(decision.reason);
  navigation_.steering_angle_rad = decision.steering_angle_rad;
  const double v = decision.max_forward_mps;
  navigation_.corridor_length_m =
      params_.robot.braking.required_distance_m(v, params_.drive.reaction_s);
  navigation_.corridor_width_m = params_.robot.body.width_m + 2.0 * params_.drive.side_margin_m;
  navigation_.clear_distance_m = decision.free_distance_m;
  navigation_.max_forward_mps = decision.max_forward_mps;
  context_.bus.publish("NAVIGATION", navigation_);

  if (odometry_) {
    display_.publish(time::from_utime(drive_.utime), navigator_, decision, T_map_odom_,
                     odometry_->T_odom_base, goal_state());
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
