// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>

#include "common/bus/bus.hpp"
#include "common/geometry/time.hpp"
#include "common/node/node.hpp"
#include "sim/devices/simulated_robot.hpp"
#include "sim/pty_line.hpp"

namespace nodmap::sim {

/// The simulated robot in real time: its three serial lines on pseudo-terminals, TRUTH on the bus.
/// Simulated time starts at 0 and follows the caller's steady clock.
class Simulator {
 public:
  /// Creates the links laser, servo and base. `start` is the wall clock at time 0.
  Simulator(SimulatedRobot& robot, const LinkDir& dir, bus::Bus& bus, time::Timestamp start);

  /// Simulates up to `now`, and exchanges bytes with the host.
  void spin_once(time::SteadyTime now);

  /// When spin_once() must be called even without bytes from the host.
  [[nodiscard]] time::SteadyTime next_due() const;
  /// File descriptors to poll for input; -1 for unplugged lines.
  [[nodiscard]] std::array<int, 3> poll_handles() const;

  [[nodiscard]] node::Health health() const;
  /// Starts a new interval for the lag that health() reports.
  void reset_lag() { max_lag_ = {}; }

  /// For result.json.
  [[nodiscard]] nlohmann::json metrics() const;

 private:
  void update_devices(time::SteadyTime now);
  void read_lines(time::SteadyTime now);
  void update_plugs(time::SteadyTime now);
  void publish_truth();

  SimulatedRobot& robot_;
  bus::Bus& bus_;
  std::array<std::unique_ptr<PtyLine>, 3> lines_;
  time::Moment start_;
  time::SteadyTime now_{};
  time::SteadyTime next_truth_{};
  std::int64_t truth_seq_ = 0;
  time::Duration max_lag_{};
  double distance_m_ = 0.0;
  double min_clearance_m_;
  Eigen::Vector3d last_position_;
};

}  // namespace nodmap::sim
