// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "common/node/goal_sender.hpp"
#include "common/node/stop_sender.hpp"
#include "modules/viewer/answer.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"
#include "modules/viewer/process_control.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "nodmap/status_t.hpp"

namespace nodmap::viewer {

using foxglove::Json;

/// A request and its answer for the log: the first 200 characters of each, because a client may
/// send any text, many times a second.
[[nodiscard]] std::string log_line(const Json& request, const Answer& answer);

/// Executes the requests of clients with control, by their member `do`:
///   goal  x_m, y_m, tolerance_m?    drive to this place in map
///   home                            drive to the map's origin (node::kHomeM)
///   roam                            cancel the goal
///   explore, end_exploration        start or end an exploration
///   stop, go                        keep the robot stationary until `go` releases it
///   save_maps                       write the maps
///   start_process, stop_process, restart_process  command
///   start_recording, stop_recording
///   process_output  command         answer with the last lines that it wrote
class RemoteControl {
 public:
  /// A request that may be older is not carried out, because the robot must not move when the link
  /// returns and nobody expects it any more; except `stop`, and what neither moves the robot nor
  /// starts or ends anything.
  static constexpr time::Duration kMaxAge = 2s;

  using Clock = std::function<time::Moment()>;

  /// `processes` may be null: then processes cannot be controlled. It and the bus must outlive this
  /// object.
  RemoteControl(bus::Bus& bus, Clock clock, ProcessControl* processes);

  /// Executes a request if possible. `age`: the greatest that it can have. An answer that is ok
  /// means that the request was sent, not that the robot has obeyed: the topics show that.
  [[nodiscard]] Answer answer(const Json& request, time::Duration age);

  /// Publishes STOP and GOAL again when that is due: STOP until the robot is released, a GOAL for
  /// as long as its request would be carried out. To be called often.
  void poll();

 private:
  Answer do_goal(const Json& request);
  Answer do_home();
  Answer do_roam();
  Answer do_explore(bool is_active);
  Answer do_stop(bool is_stopped);
  Answer do_save_maps();
  Answer do_process(procman::Verb verb, const std::string& command);
  Answer do_recording(procman::Verb verb);
  Answer do_process_output(const std::string& command);
  // Sends it and says so, beginning with this text.
  Answer send_goal(const Eigen::Vector2d& p_map, double tolerance_m, std::string text);
  void on_map(const nodmap::grid_chunk_t& tile);
  void on_status(const nodmap::status_t& status);
  /// A sentence if none of these processes has reported lately; otherwise nothing.
  [[nodiscard]] std::string note_if_silent(std::initializer_list<const char*> processes) const;

  bus::Bus& bus_;
  Clock clock_;
  ProcessControl* processes_;
  node::GoalSender goal_sender_;
  std::optional<time::SteadyTime> goal_asked_;  // while that goal may still be repeated
  node::StopSender stop_sender_;
  std::optional<Eigen::AlignedBox2d> map_m_;          // extent of the newest MAP_2D
  std::map<std::string, time::SteadyTime> reported_;  // when we received the last STATUS of each
};

}  // namespace nodmap::viewer
