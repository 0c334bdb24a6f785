// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "common/node/clock.hpp"
#include "modules/viewer/process_control.hpp"
#include "modules/viewer/session.hpp"
#include "nodmap/grid_chunk_t.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::viewer {

/// What a client with control may ask for, by `do`:
///   goal  x_m, y_m, tolerance_m?    drive there (map)
///   roam                            no goal any more
///   explore, end_exploration        the explorer drives, until all is seen and it is home
///   stop                            the robot stands, whatever comes, until
///   go
///   save_maps                       write the maps
///   start_process, stop_process, restart_process  command
///   start_recording, stop_recording
///   process_output  command: the last lines that it wrote
class RemoteControl {
 public:
  /// A STOP is published again so often: base driver and navigator keep it, this is for one that
  /// has missed it or was started since.
  static constexpr time::Duration kRepeat = 200ms;

  /// `processes` may be null: then there is no control over them. All must outlive this object.
  RemoteControl(bus::Bus& bus, const time::Clock& clock, ProcessControl* processes);

  /// Does what the request says, if it can.
  [[nodiscard]] Answer answer(const Json& request);

  /// To be called often: publishes STOP again when it is due.
  void turn();

 private:
  Answer do_goal(const Json& request);
  Answer do_stop(bool is_stopped);
  Answer do_save_maps();
  Answer do_explore(bool is_active);
  Answer do_process(const std::string& what, const Json& request);
  void on_stop(const nodmap::stop_t& message);
  void on_map(const nodmap::grid_chunk_t& tile);
  void send_goal(bool is_active, double x_m, double y_m, double tolerance_m);
  void send_stop();

  bus::Bus& bus_;
  const time::Clock& clock_;
  ProcessControl* processes_;
  std::int64_t goal_seq_ = 0;
  nodmap::stop_t stop_{};                     // the newest of ours
  std::optional<Eigen::AlignedBox2d> map_m_;  // extent of the newest MAP_2D
};

}  // namespace nodmap::viewer
