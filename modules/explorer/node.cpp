// SPDX-License-Identifier: BSD-3-Clause
#include "modules/explorer/node.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/node/log.hpp"
#include "common/node/messages.hpp"

namespace nodmap::explorer {
namespace {

using node::GoalSender;

constexpr time::Duration kDecisionPeriod = 500ms;
// The least time between decisions, when the navigator has just arrived.
constexpr time::Duration kArrivalPeriod = 100ms;
// After this long without a pose of 2D SLAM nothing is decided. A stationary robot gets one a
// second.
constexpr time::Duration kPoseTimeout = 5s;
// The navigator says several times a second that there is no path. While it halts, it says so only
// of a goal outside the geofence.
constexpr time::Duration kPathTimeout = 1s;
// After this long without NAVIGATION, which comes with every DRIVE, there is no navigator.
constexpr time::Duration kNavigatorTimeout = 2s;
// A robot that may not drive for this long while it is to explore is reported.
constexpr time::Duration kLongestHalt = 10s;
// A goal nearer to the last one than this counts as the same.
constexpr double kSameGoalM = 0.05;
constexpr const char* kLost = "2D SLAM is lost: the exploration waits for a pose.";
constexpr const char* kNoPose = "No pose comes from 2D SLAM: the exploration waits for one.";
// With this limit EXPLORATION stays far below 64 KiB.
constexpr std::size_t kMaxPathPoints = 500;
constexpr std::size_t kMaxFrontierPoints = 2000;

std::int8_t code_of(State state) {
  switch (state) {
    case State::kIdle:
      break;
    case State::kExploring:
      return nodmap::exploration_t::EXPLORING;
    case State::kReturning:
      return nodmap::exploration_t::RETURNING;
    case State::kHome:
      return nodmap::exploration_t::HOME;
  }
  return nodmap::exploration_t::IDLE;
}

// The step n for which every n-th of `count` items gives at most `most`.
std::size_t stride(std::size_t count, std::size_t most) {
  return (count + most - 1) / most;
}

}  // namespace

ExplorerNode::ExplorerNode(node::Context& context, const Params& params)
    : context_(context),
      params_(params),
      input_(context.counts, &context.bus),
      map_input_(context.counts, context.bus),
      explorer_(params),
      goal_sender_(context.bus) {
  bus::Bus& bus = context.bus;
  bus.subscribe<nodmap::grid_chunk_t>("MAP_2D", [this](const auto& m) { on_map(m); });
  bus.subscribe<nodmap::pose_t>("POSE_2D", [this](const auto& m) { on_pose(m); });
  bus.subscribe<nodmap::odometry_t>("ODOMETRY", [this](const auto& m) { on_odometry(m); });
  bus.subscribe<nodmap::navigation_t>("NAVIGATION", [this](const auto& m) { on_navigation(m); });
  bus.subscribe<nodmap::path_t>("PATH", [this](const auto& m) { on_path(m); });
  bus.subscribe<nodmap::explore_t>("EXPLORE", [this](const auto& m) { on_explore(m); });
  bus.subscribe<nodmap::goal_t>("GOAL", [this](const auto& m) { on_goal(m); });
  bus.subscribe<nodmap::stop_t>("STOP", [this](const auto& m) { on_stop(m); });
  if (params.start) {
    start();
  }
}

void ExplorerNode::on_map(const nodmap::grid_chunk_t& message) {
  const auto read = map_input_.read(message);
  if (!read) {
    return;
  }
  if (read->begins_map) {
    begin_new_map();
  }
  if (!explorer_.add(read->tile)) {
    context_.counts.reject("map_tile_of_unusable_size");
    return;
  }
  context_.counts.use();
}

// Home and goal are positions in a map that no longer exists.
void ExplorerNode::begin_new_map() {
  explorer_.forget_map();
  const bool has_decided = explorer_.state() != State::kIdle && num_decisions_ > 0;
  if (has_decided) {
    end("The 2D map was restarted.");
  }
  const GoalSender::Status status = goal_sender_.status();
  const bool follows_our_goal =
      status == GoalSender::Status::kSent || status == GoalSender::Status::kTaken;
  if (has_decided || follows_our_goal) {
    stay_ = StayAfterEnd::kPending;
  }
  goal_.reset();  // the same coordinates are another place now
}

void ExplorerNode::on_pose(const nodmap::pose_t& message) {
  const auto T_map_odom = node::read_pose(message.odom_position_m, message.odom_orientation);
  if (!T_map_odom || !time::is_plausible(node::stamp_of(message))) {
    context_.counts.reject("implausible_pose");
    return;
  }
  context_.counts.use();
  if (map_input_.follow_pose()) {
    begin_new_map();
  }
  is_lost_ = message.state == nodmap::pose_t::LOST;
  if (!is_lost_) {
    T_map_odom_ = geometry::to_se2(*T_map_odom);
    posed_ = node::stamp_of(message);
  }
}

// Poses of 2D SLAM come with level scans, one a second when the robot is slow. Odometry says where
// it is in between.
void ExplorerNode::on_odometry(const nodmap::odometry_t& message) {
  const auto T_odom_base = input_.read(message);
  if (!T_odom_base) {
    return;
  }
  context_.counts.use();
  if (input_.odometry_restarted()) {
    T_map_odom_.reset();  // the base driver was restarted: odom is another frame
  }
  T_odom_base_ = geometry::to_se2(*T_odom_base);
  const time::Timestamp now = node::stamp_of(message);
  odometry_at_ = now;
  repeat_goal(now);
  if (stay_ == StayAfterEnd::kPending && pose_fault(now).empty()) {
    keep_place(now);
  }
  if (time::is_due(now, decided_, has_just_arrived_ ? kArrivalPeriod : kDecisionPeriod)) {
    decided_ = now;
    has_just_arrived_ = false;
    decide(now);
  }
}

void ExplorerNode::on_navigation(const nodmap::navigation_t& message) {
  context_.counts.use();
  navigated_at_ = node::stamp_of(message);
  navigator_halt_.reset();
  if (message.behaviour == nodmap::navigation_t::HALT) {
    navigator_halt_ = node::read_name(message.reason);
  }
  if (!goal_sender_.take(message)) {
    return;
  }
  const bool has_arrived = message.behaviour == nodmap::navigation_t::ARRIVED;
  has_just_arrived_ = has_just_arrived_ || (has_arrived && !has_arrived_);
  has_arrived_ = has_arrived;
}

void ExplorerNode::on_path(const nodmap::path_t& message) {
  context_.counts.use();
  if (goal_sender_.is_about(message.goal_utime)) {
    no_path_at_.reset();
    if (message.state == nodmap::path_t::NO_PATH) {
      no_path_at_ = node::stamp_of(message);
    }
  }
}

void ExplorerNode::on_explore(const nodmap::explore_t& message) {
  context_.counts.use();
  if (message.is_active != 0 && !explores()) {
    log::get().info("{} starts the exploration", node::read_name(message.requested_by));
    start();
    // Who asked sees that it has been started, even if the first decision ends it.
    decided_ = node::stamp_of(message);
    publish_state("Starting.", *decided_);
  } else if (message.is_active == 0 && explorer_.state() != State::kIdle) {
    end("Ended by " + node::read_name(message.requested_by) + ".");
    stay_ = StayAfterEnd::kPending;
    if (T_map_base()) {
      keep_place(node::stamp_of(message));
    }
    publish_state(idle_reason_, node::stamp_of(message));
  }
}

// A goal, or its cancellation, of another sender ends the exploration. It is older than the
// exploration if it only repeats what came before EXPLORE: our first goal overrules it.
void ExplorerNode::on_goal(const nodmap::goal_t& message) {
  context_.counts.use();
  if (!goal_sender_.take(message)) {
    return;
  }
  const bool is_repeated = std::exchange(others_goal_utime_, message.utime) == message.utime;
  if (is_repeated && explores() && !goal_) {
    return;
  }
  stay_ = StayAfterEnd::kNone;
  if (explorer_.state() != State::kIdle) {
    end("Another sender has set a goal.");
  }
}

// During a STOP the exploration waits, and continues when the robot is released.
void ExplorerNode::on_stop(const nodmap::stop_t& message) {
  context_.counts.use();
  const bool is_released = stop_latch_.take(message) == node::StopLatch::Change::kReleased;
  if (is_released && stay_ == StayAfterEnd::kSent) {
    stay_ = StayAfterEnd::kPending;  // meanwhile somebody may have moved the robot: no driving back
  }
}

// Home is where the robot is now, also if it is stopped and moved before the first decision. If
// that is not known, it is where the robot is by then.
void ExplorerNode::start() {
  const bool is_place_known = odometry_at_ && pose_fault(*odometry_at_).empty();
  explorer_.start(is_place_known ? std::optional(T_map_base()->translation()) : std::nullopt);
  goal_.reset();
  stay_ = StayAfterEnd::kNone;
  num_decisions_ = 0;
}

void ExplorerNode::end(const std::string& reason) {
  log::get().info("the exploration ends: {}", reason);
  idle_reason_ = reason;
  explorer_.end();
}

bool ExplorerNode::explores() const {
  return explorer_.state() == State::kExploring || explorer_.state() == State::kReturning;
}

std::optional<geometry::SE2> ExplorerNode::T_map_base() const {
  return T_map_odom_ && T_odom_base_ ? std::optional(*T_map_odom_ * *T_odom_base_) : std::nullopt;
}

void ExplorerNode::keep_place(time::Timestamp now) {
  send_goal({T_map_base()->translation(), params_.goal_tolerance_m}, now);
  stay_ = StayAfterEnd::kSent;
}

// While it explores, the robot drives to its goals only. Afterwards a goal that the navigator has
// taken is not repeated, because that would overrule somebody whose GOAL was missed.
void ExplorerNode::repeat_goal(time::Timestamp now) {
  const bool is_wanted = explores() || goal_sender_.status() == GoalSender::Status::kSent;
  if (is_wanted && stay_ != StayAfterEnd::kPending && !stop_latch_.is_stopped()) {
    goal_sender_.repeat_if_due(now);
  }
}

void ExplorerNode::decide(time::Timestamp now) {
  if (stop_latch_.is_stopped() && explorer_.state() != State::kIdle) {
    halted_since_.reset();  // what kept it from driving before is counted anew
    publish_state("The robot is stopped.", now);
    return;
  }
  const std::string fault = pose_fault(now);
  halt_reason_ = fault.empty() ? halt_reason(now) : fault;
  halted_since_ = explores() && !halt_reason_.empty() ? std::optional(halted_since_.value_or(now))
                                                      : std::nullopt;
  if (explores() && !fault.empty()) {
    publish_state(fault, now);
    return;
  }
  const Decision decision = next_decision(now);
  seen_m2_ = decision.seen_m2;
  if (decision.goal) {
    send_goal(*decision.goal, now);
  }
  publish(decision, now);
}

Decision ExplorerNode::next_decision(time::Timestamp now) {
  const bool was_idle = explorer_.state() == State::kIdle;
  const bool has_no_path = no_path_at_ && !time::is_due(now, no_path_at_, kPathTimeout);
  Decision decision = explorer_.decide({.stamp = now,
                                        .T_map_base = T_map_base().value_or(geometry::SE2{}),
                                        .may_drive = halt_reason_.empty() || has_no_path,
                                        .has_no_path = has_no_path,
                                        .has_arrived = has_arrived_});
  if (decision.state == State::kIdle && !was_idle) {
    end(decision.reason);
  } else if (decision.state == State::kIdle) {
    decision.reason = idle_reason_;
  } else {
    ++num_decisions_;
    if (explores() && !halt_reason_.empty()) {
      decision.reason = halt_reason_;
    }
  }
  return decision;
}

std::string ExplorerNode::pose_fault(time::Timestamp now) const {
  if (is_lost_) {
    return kLost;
  }
  return T_map_odom_ && !time::is_due(now, posed_, kPoseTimeout) ? "" : kNoPose;
}

std::string ExplorerNode::halt_reason(time::Timestamp now) const {
  if (!navigated_at_ || time::is_due(now, *navigated_at_, kNavigatorTimeout)) {
    return "No nodmap-navigator reports, so the robot does not drive.";
  }
  return navigator_halt_ ? "The robot may not drive: " + *navigator_halt_ : "";
}

void ExplorerNode::send_goal(const Goal& goal, time::Timestamp now) {
  if (goal_ && (goal.p_map - goal_->p_map).norm() <= kSameGoalM &&
      goal.tolerance_m == goal_->tolerance_m) {
    return;
  }
  goal_ = goal;
  no_path_at_.reset();
  has_arrived_ = false;
  nodmap::goal_t message{};
  message.position_m[0] = goal.p_map.x();
  message.position_m[1] = goal.p_map.y();
  message.tolerance_m = goal.tolerance_m;
  goal_sender_.set(message, now);
}

void ExplorerNode::publish_state(const std::string& reason, time::Timestamp now) {
  Decision decision;
  decision.state = explorer_.state();
  decision.reason = reason;
  decision.seen_m2 = seen_m2_;
  publish(decision, now);
}

void ExplorerNode::publish(const Decision& decision, time::Timestamp now) {
  nodmap::exploration_t message{};
  message.utime = time::to_utime(now);
  message.state = code_of(decision.state);
  message.reason = decision.reason;
  message.seen_m2 = decision.seen_m2;
  message.waiting_m2 = decision.waiting_m2;
  for (const Viewpoint& viewpoint : decision.tour) {
    message.viewpoint_x_m.push_back(viewpoint.p_map.x());
    message.viewpoint_y_m.push_back(viewpoint.p_map.y());
    message.gain_m2.push_back(viewpoint.gain_m2);
  }
  message.num_viewpoints = static_cast<std::int32_t>(decision.tour.size());
  const auto& path = decision.path_map;
  for (std::size_t i = 0; i < path.size(); i += stride(path.size(), kMaxPathPoints)) {
    message.x_m.push_back(path[i].x());
    message.y_m.push_back(path[i].y());
  }
  message.num_points = static_cast<std::int32_t>(message.x_m.size());
  const auto& frontier = decision.frontier_map;
  for (std::size_t i = 0; i < frontier.size(); i += stride(frontier.size(), kMaxFrontierPoints)) {
    message.frontier_x_m.push_back(frontier[i].x());
    message.frontier_y_m.push_back(frontier[i].y());
  }
  message.num_frontier_points = static_cast<std::int32_t>(message.frontier_x_m.size());
  context_.bus.publish("EXPLORATION", message);
}

nlohmann::json ExplorerNode::metrics() const {
  return {{"decisions", num_decisions_},
          {"goals", goal_sender_.num_published()},
          {"failures", explorer_.num_failures()},
          {"seen_m2", seen_m2_}};
}

node::Health ExplorerNode::health() const {
  if (is_lost_ && explorer_.state() != State::kIdle) {
    return {node::HealthState::kDegraded, kLost};
  }
  if (halted_since_ && time::is_due(*odometry_at_, *halted_since_, kLongestHalt)) {
    return {node::HealthState::kDegraded, halt_reason_};
  }
  return {};
}

}  // namespace nodmap::explorer
