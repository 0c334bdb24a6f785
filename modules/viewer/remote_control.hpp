// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/bus/bus.hpp"
#include "common/foxglove/foxglove.hpp"
#include "common/geometry/se3.hpp"
#include "common/time/clock.hpp"

namespace nodmap::viewer {

using foxglove::Json;

/// What a client with control may ask for, by topic:
///   GOAL  {"x_m", "y_m", "tolerance_m"?}   drive there (map); {"clear": true}: no goal any more
///   STOP  {}                               stand: the goal is where the robot is
///   SAVE_REQUEST {}                        write the maps
class RemoteControl {
 public:
  /// Both must outlive this object.
  RemoteControl(bus::Bus& bus, const time::Clock& clock) : bus_(bus), clock_(clock) {}

  /// Why the request was refused; empty when it was published. `T_map_base` is the newest pose.
  std::string publish(const std::string& topic, const Json& request,
                      const std::optional<geometry::SE3>& T_map_base);

 private:
  std::string publish_goal(const Json& request);
  std::string publish_stop(const std::optional<geometry::SE3>& T_map_base);
  std::string publish_save_request();
  void send_goal(bool is_active, double x_m, double y_m, double tolerance_m);

  bus::Bus& bus_;
  const time::Clock& clock_;
  std::int64_t goal_seq_ = 0;
};

}  // namespace nodmap::viewer
