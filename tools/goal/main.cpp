// SPDX-License-Identifier: BSD-3-Clause
// nodmap-goal: sends the robot to one place or through several.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/live_bus.hpp"
#include "common/geometry/angle.hpp"
#include "common/geometry/clock.hpp"
#include "common/node/goal_sender.hpp"
#include "common/node/messages.hpp"
#include "common/node/option_checks.hpp"
#include "common/node/program.hpp"
#include "nodmap/goal_t.hpp"
#include "nodmap/navigation_t.hpp"
#include "nodmap/path_t.hpp"
#include "tools/goal/route.hpp"

namespace nodmap {
namespace {

constexpr std::chrono::milliseconds kLongestWait(100);
// On patrol the robot stays this long where it already is when it is sent there.
constexpr time::Duration kMinStay = 1s;
constexpr double kToleranceM = 0.2;
constexpr double kDockingToleranceM = 0.02;

struct Arguments {
  std::vector<double> coordinates_m;  // x and y of each waypoint
  std::optional<double> tolerance_m;
  std::optional<double> heading_deg;
  double heading_tolerance_deg = 1.0;
  double patience_s = 20.0;
  double wait_s = 10.0;
  bool is_patrol = false;
  bool goes_home = false;
};

std::vector<Eigen::Vector2d> read_waypoints(const Arguments& arguments) {
  const std::vector<double>& coordinates_m = arguments.coordinates_m;
  if (coordinates_m.empty() && !arguments.goes_home) {
    throw node::UsageError("WAYPOINTS or --home is required");
  }
  if (coordinates_m.size() % 2 != 0) {
    throw node::UsageError("WAYPOINTS: each needs an x and a y; the number of coordinates, " +
                           std::to_string(coordinates_m.size()) + ", is odd");
  }
  std::vector<Eigen::Vector2d> waypoints_map;
  for (std::size_t i = 0; i < coordinates_m.size(); i += 2) {
    waypoints_map.emplace_back(coordinates_m[i], coordinates_m[i + 1]);
  }
  if (arguments.goes_home) {
    waypoints_map.emplace_back(node::kHomeM.data());
  }
  return waypoints_map;
}

// Sends the robot along a route and reports the result for each waypoint.
class Guide {
 public:
  Guide(const Arguments& arguments, bus::LiveBus& bus)
      : arguments_(arguments),
        bus_(bus),
        goal_sender_(bus),
        route_(read_waypoints(arguments), arguments.is_patrol,
               time::from_seconds(arguments.patience_s)) {
    bus_.subscribe<navigation_t>("NAVIGATION", [this](const navigation_t& m) {
      if (!goal_sender_.take(m)) {
        return;
      }
      obeyed_ = time::steady_now();
      reason_ = node::read_name(m.reason);
      tell_halt(m.behaviour == navigation_t::HALT ? reason_ : "");
      if (!arguments_.is_patrol || obeyed_ - decided_ >= kMinStay) {
        tell(route_.take_arrival(m.behaviour == navigation_t::ARRIVED));
      }
    });
    bus_.subscribe<path_t>("PATH", [this](const path_t& m) {
      if (goal_sender_.is_about(m.goal_utime)) {
        tell(route_.take_path(m.state != path_t::NO_PATH, time::steady_now()));
      }
    });
    bus_.subscribe<goal_t>("GOAL", [this](const goal_t& m) { goal_sender_.take(m); });
  }

  // Returns the exit code.
  int run() {
    set_goal();
    obeyed_ = time::steady_now();
    while (!route_.is_over() && !is_overruled() && !node::stop_requested()) {
      if (time::steady_now() - obeyed_ > time::from_seconds(arguments_.wait_s)) {
        std::cerr << "nodmap-goal: for " << arguments_.wait_s
                  << " s no nodmap-navigator has reported on this goal\n";
        return 1;
      }
      goal_sender_.repeat_if_due(time::SystemClock().now());
      bus_.handle(kLongestWait);
    }
    if (is_overruled()) {
      std::cerr << "nodmap-goal: another process has sent a goal, and the robot now drives there\n";
    } else if (!route_.is_over()) {
      std::cerr << "nodmap-goal: ended early; " << what_lasts() << "\n";
    }
    return route_.is_over() && route_.num_missed() == 0 ? 0 : 1;
  }

 private:
  // Makes the route's waypoint the goal.
  void set_goal() {
    goal_t goal{};
    goal.position_m[0] = route_.waypoint_map().x();
    goal.position_m[1] = route_.waypoint_map().y();
    const bool docks = arguments_.heading_deg.has_value() && route_.index() + 1 == route_.size();
    goal.tolerance_m = tolerance_m(docks);
    goal.has_heading = static_cast<std::int8_t>(docks);
    goal.heading_rad = geometry::deg_to_rad(arguments_.heading_deg.value_or(0.0));
    goal.heading_tolerance_rad = geometry::deg_to_rad(arguments_.heading_tolerance_deg);
    goal_sender_.set(goal, time::SystemClock().now());
    decided_ = time::steady_now();
  }

  [[nodiscard]] bool is_overruled() const {
    return goal_sender_.status() == node::GoalSender::Status::kOverruled;
  }

  // With a heading, --tolerance applies to the last waypoint only.
  [[nodiscard]] double tolerance_m(bool docks) const {
    if (docks) {
      return arguments_.tolerance_m.value_or(kDockingToleranceM);
    }
    return arguments_.heading_deg ? kToleranceM : arguments_.tolerance_m.value_or(kToleranceM);
  }

  void tell(Route::Event event) {
    if (event == Route::Event::kNone) {
      return;
    }
    std::cout << "waypoint " << told_index_ + 1 << " of " << route_.size()
              << (event == Route::Event::kReached ? " reached" : " missed" + why_missed())
              << std::endl;
    told_index_ = route_.index();
    if (!route_.is_over() && !is_overruled()) {
      set_goal();
    }
  }

  // Says once why the robot may not drive; empty: it may.
  void tell_halt(const std::string& reason) {
    if (!reason.empty() && reason != told_halt_) {
      std::cout << "the robot may not drive; the navigator says: " << reason << std::endl;
    }
    told_halt_ = reason;
  }

  [[nodiscard]] std::string what_lasts() const {
    if (goal_sender_.status() != node::GoalSender::Status::kTaken) {
      return "no nodmap-navigator has reported on this goal";
    }
    std::ostringstream text;
    text << "the robot still drives to " << route_.waypoint_map().x() << " "
         << route_.waypoint_map().y() << " and stays there (nodmap-stop stops it)";
    return text.str();
  }

  [[nodiscard]] std::string why_missed() const {
    return reason_.empty() ? ": there is no path" : "; the navigator says: " + reason_;
  }

  Arguments arguments_;
  bus::LiveBus& bus_;
  node::GoalSender goal_sender_;
  Route route_;
  time::SteadyTime decided_{};
  time::SteadyTime obeyed_{};  // when the navigator last reported on this goal
  std::string reason_;         // of its behaviour, in that report
  std::string told_halt_;
  std::size_t told_index_ = 0;
};

int run(const Arguments& arguments, const std::string& lcm_url) {
  bus::LiveBus bus(lcm_url);
  return Guide(arguments, bus).run();
}

}  // namespace
}  // namespace nodmap

int main(int argc, char** argv) {
  using namespace nodmap;
  Arguments arguments;
  return node::run_program(
      argc, argv,
      {.name = "nodmap-goal",
       .summary = "Sends the robot to one place or through several, one after the other, and exits "
                  "when it is there.",
       .uses_lcm = true,
       .add_options =
           [&arguments](CLI::App& app) {
             app.add_option("WAYPOINTS", arguments.coordinates_m,
                            "X Y of each waypoint in map, metres")
                 ->check(node::in_range(-node::kMaxCoordinateM, node::kMaxCoordinateM));
             app.add_flag("--home", arguments.goes_home,
                          "Drive home, after the waypoints if any: to 0 0, the origin of the map, "
                          "where odometry began, or the origin of the saved map");
             app.add_flag("--patrol", arguments.is_patrol,
                          "Start again after the last, until Ctrl-C; then the robot stays at the "
                          "waypoint that it drives to");
             app.add_option("--tolerance", arguments.tolerance_m,
                            "Distance at which a waypoint counts as reached, metres; default 0.2; "
                            "with --heading, 0.02 for the last one")
                 ->check(node::in_range(0.01, node::kMaxGoalToleranceM));
             auto* heading =
                 app.add_option("--heading", arguments.heading_deg,
                                "Dock at the last waypoint with this heading in map, degrees, 0 "
                                "along x, 90 along y; needs 0.8 m of free floor straight behind it")
                     ->check(node::in_range(-360.0, 360.0));
             app.add_option(
                    "--heading-tolerance", arguments.heading_tolerance_deg,
                    "Largest error of the heading with which the robot counts as docked, degrees")
                 ->check(node::in_range(0.1, 90.0))
                 ->capture_default_str()
                 ->needs(heading);
             app.add_option("--patience", arguments.patience_s,
                            "Seconds without a path after which a waypoint is missed")
                 ->check(node::in_range(1.0, 3600.0))
                 ->capture_default_str();
             app.add_option("--wait", arguments.wait_s,
                            "Seconds without a report of the navigator on the goal after which to "
                            "give up")
                 ->check(node::in_range(0.1, 3600.0))
                 ->capture_default_str();
           },
       .run = [&arguments](const std::string& lcm_url) { return run(arguments, lcm_url); }});
}
