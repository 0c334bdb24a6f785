// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>

#include "common/bus/bus.hpp"
#include "common/node/node.hpp"
#include "sim/devices/simulated_robot.hpp"
#include "sim/pty_line.hpp"

namespace nodmap::sim {

/// The simulated robot in real time: its three serial lines on pseudo-terminals, TRUTH on the bus.
/// Simulated time is microseconds since the start on the caller's monotonic clock.
class Simulator {
 public:
  /// Creates the links laser, servo and base. `start_utime_us` is the wall clock at time 0.
  Simulator(SimulatedRobot& robot, const LinkDir& dir, bus::Bus& bus, std::int64_t start_utime_us);

  /// Simulates up to `now_us`, and exchanges bytes with the host.
  void spin_once(std::int64_t now_us);

  /// When spin_once() has something to do even without bytes from the host.
  [[nodiscard]] std::int64_t next_us() const;
  /// File descriptors to poll for input; -1 for unplugged lines.
  [[nodiscard]] std::array<int, 3> poll_handles() const;

  [[nodiscard]] node::Health health() const;
  /// Starts a new interval for the lag that health() reports.
  void reset_lag() { max_lag_us_ = 0; }

  /// For result.json.
  [[nodiscard]] nlohmann::json metrics() const;

 private:
  void update_devices(std::int64_t now_us);
  void read_lines(std::int64_t now_us);
  void update_plugs(std::int64_t now_us);
  void publish_truth();

  SimulatedRobot& robot_;
  bus::Bus& bus_;
  std::array<std::unique_ptr<PtyLine>, 3> lines_;
  std::int64_t start_utime_us_;
  std::int64_t now_us_ = 0;
  std::int64_t next_truth_us_ = 0;
  std::int64_t truth_seq_ = 0;
  std::int64_t max_lag_us_ = 0;
  double distance_m_ = 0.0;
  double min_clearance_m_;
  Eigen::Vector3d last_position_;
};

}  // namespace nodmap::sim
