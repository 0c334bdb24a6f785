// SPDX-License-Identifier: BSD-3-Clause
#include "modules/navigator/display.hpp"

#include <vector>

#include "modules/navigator/messages.hpp"

namespace nodmap::navigator {
namespace {

// From one PATH to the next, and from one TRACKS to the next.
constexpr time::Duration kPeriod = 100ms;

// From one LOCAL_MAP to the next, and how far it reaches to each side: 25 kB.
constexpr time::Duration kLocalMapPeriod = 500ms;
constexpr double kLocalMapHalfSizeM = 4.0;

}  // namespace

void Display::publish(time::Timestamp stamp, const Navigator& navigator, const Decision& decision,
                      const Inputs& newest) {
  publish_path(stamp, navigator, decision, newest);
  publish_tracks(stamp, navigator);
  publish_local_map(stamp, navigator.local_map(), newest.odometry->T_odom_base);
}

// Published while there is a goal, and once more when it has ended. While the robot halts nothing
// is planned: the plan may belong to a former goal.
void Display::publish_path(time::Timestamp stamp, const Navigator& navigator,
                           const Decision& decision, const Inputs& newest) {
  const GoalState goal = newest.goal_state();
  const bool halts = decision.behaviour == Behaviour::kHalt;
  if (goal == GoalState::kInside && halts) {
    return;
  }
  if (goal == GoalState::kNone ? !path_stamp_ : !time::is_due(stamp, path_stamp_, kPeriod)) {
    return;
  }
  path_stamp_.reset();
  nodmap::path_t message{};
  message.state = nodmap::path_t::NO_GOAL;
  if (goal != GoalState::kNone) {
    const auto path_map = goal == GoalState::kOutsideFence
                              ? std::vector<Eigen::Vector2d>{}
                              : navigator.path_map(newest.T_map_base(), newest.goal->T_map_goal);
    if (!path_map) {
      return;  // not yet planned, or not by plan
    }
    path_stamp_ = stamp;
    message = path_message(*path_map, newest.pose.T_map_odom.inverse(),
                           newest.odometry->T_odom_base, decision);
  }
  message.goal_utime = newest.goal_utime();
  message.utime = time::to_utime(stamp);
  bus_.publish("PATH", message);
}

// Published while anybody is tracked, and once more when nobody is.
void Display::publish_tracks(time::Timestamp stamp, const Navigator& navigator) {
  if (!time::is_due(stamp, tracks_stamp_, kPeriod)) {
    return;
  }
  nodmap::tracks_t message = tracks_message(navigator.people().people_odom(stamp),
                                            navigator.people().newcomers_odom(stamp));
  if (message.num_tracks == 0 && !tracks_stamp_) {
    return;
  }
  tracks_stamp_.reset();
  if (message.num_tracks > 0) {
    tracks_stamp_ = stamp;
  }
  message.utime = time::to_utime(stamp);
  bus_.publish("TRACKS", message);
}

void Display::publish_local_map(time::Timestamp stamp, const LocalMap& local_map,
                                const geometry::SE2& T_odom_base) {
  if (!local_map.has_scan() || !time::is_due(stamp, local_map_stamp_, kLocalMapPeriod)) {
    return;
  }
  local_map_stamp_ = stamp;
  nodmap::local_map_t message =
      local_map_message(local_map, T_odom_base.translation(), kLocalMapHalfSizeM);
  message.utime = time::to_utime(stamp);
  bus_.publish("LOCAL_MAP", message);
}

}  // namespace nodmap::navigator
