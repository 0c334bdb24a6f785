// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/bus/bus.hpp"
#include "common/node/clock.hpp"
#include "modules/viewer/process_control.hpp"
#include "modules/viewer/session.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap::viewer {

/// What a client with control may ask for, by `do`:
///   goal  x_m, y_m, tolerance_m?    drive there (map)
///   roam                            no goal any more
///   stop                            stand, whatever comes, until
///   go
///   save_maps                       write the maps
///   start_process, stop_process, restart_process  command
///   start_recording, stop_recording
class RemoteControl {
 public:
  /// So often a STOP is said again: base driver and navigator keep it, this is for one that has
  /// missed it or begun anew.
  static constexpr std::int64_t kRepeatUs = 200'000;

  /// `processes` may be null: then there is no control over them. All must outlive this object.
  RemoteControl(bus::Bus& bus, const time::Clock& clock, ProcessControl* processes);

  /// Does what the request says, if it can.
  [[nodiscard]] Answer answer(const Json& request);

  /// To be called often: says STOP again.
  void turn();

 private:
  Answer do_goal(const Json& request);
  Answer do_stop(bool is_stopped);
  Answer do_save_maps();
  Answer do_process(const std::string& what, const Json& request);
  void on_stop(const nodmap::stop_t& message);
  void send_goal(bool is_active, double x_m, double y_m, double tolerance_m);
  void send_stop();

  bus::Bus& bus_;
  const time::Clock& clock_;
  ProcessControl* processes_;
  std::int64_t goal_seq_ = 0;
  nodmap::stop_t stop_{};  // the newest of ours
};

}  // namespace nodmap::viewer
