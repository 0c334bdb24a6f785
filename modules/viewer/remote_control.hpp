// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "common/node/clock.hpp"
#include "modules/viewer/answer.hpp"
#include "modules/viewer/foxglove/foxglove.hpp"
#include "modules/viewer/process_control.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::viewer {

using foxglove::Json;

/// Executes the requests of clients with control, by their member `do`:
///   goal  x_m, y_m, tolerance_m?    drive to this place in map
///   roam                            cancel the goal
///   explore, end_exploration        start or end an exploration
///   stop, go                        keep the robot stationary until `go` releases it
///   save_maps                       write the maps
///   start_process, stop_process, restart_process  command
///   start_recording, stop_recording
///   process_output  command         answer with the last lines that it wrote
class RemoteControl {
 public:
  /// Period at which STOP is published again, for a process that has missed it or was started
  /// later. Base driver and navigator remember a STOP.
  static constexpr time::Duration kRepeat = 200ms;

  /// A request that may be older is not carried out, because the robot must not move when the link
  /// returns and nobody expects it any more; except `stop`, and what neither moves the robot nor
  /// starts or ends anything.
  static constexpr time::Duration kMaxAge = 2s;

  /// `processes` may be null: then processes cannot be controlled. All must outlive this object.
  RemoteControl(bus::Bus& bus, const time::Clock& clock, ProcessControl* processes);

  /// Executes a request if possible. `age`: the greatest that it can have.
  [[nodiscard]] Answer answer(const Json& request, time::Duration age);

  /// Publishes STOP again when that is due. To be called often.
  void poll();

 private:
  Answer do_goal(const Json& request);
  Answer do_roam();
  Answer do_explore(bool is_active);
  Answer do_stop(bool is_stopped);
  Answer do_save_maps();
  Answer do_process(procman::Verb verb, const std::string& command);
  Answer do_recording(procman::Verb verb);
  Answer do_process_output(const std::string& command);
  void on_stop(const nodmap::stop_t& message);
  void on_map(const nodmap::grid_chunk_t& tile);
  void send_goal(bool is_active, double x_m, double y_m, double tolerance_m);
  void send_stop();

  bus::Bus& bus_;
  const time::Clock& clock_;
  ProcessControl* processes_;
  std::int64_t goal_seq_ = 0;
  nodmap::stop_t stop_{};                     // our newest STOP
  time::Timestamp stop_sent_{};               // when it was sent last
  std::optional<Eigen::AlignedBox2d> map_m_;  // extent of the newest MAP_2D
};

}  // namespace nodmap::viewer
