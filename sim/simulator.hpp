// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>

#include "common/bus/bus.hpp"
#include "common/node/node.hpp"
#include "sim/pty_line.hpp"
#include "sim/robot.hpp"

namespace nodmap::sim {

/// The robot in real time: its three lines on pseudo-terminals, TRUTH on the bus. Simulated time is
/// microseconds since the start on the caller's monotonic clock.
class Simulator {
 public:
  /// Makes the links laser, servo and base. `start_utime_us` is the wall clock at time 0.
  Simulator(Robot& robot, const LinkDir& dir, bus::Bus& bus, std::int64_t start_utime_us);

  /// Catches up with the clock: what the devices did meanwhile, and what the host said.
  void turn(std::int64_t now_us);

  /// When turn() has something to do without the host having said anything.
  [[nodiscard]] std::int64_t next_us() const;
  /// To be polled for input; -1 for those that are unplugged.
  [[nodiscard]] std::array<int, 3> poll_handles() const;

  [[nodiscard]] node::Health health() const;
  /// To be called once a second: from now on only what comes is judged.
  void begin_second() { worst_lag_us_ = 0; }

  /// How the run went, for result.json.
  [[nodiscard]] nlohmann::json metrics() const;

 private:
  void run_devices(std::int64_t now_us);
  void listen(std::int64_t now_us);
  void plug(std::int64_t now_us);
  void tell_truth();

  Robot& robot_;
  bus::Bus& bus_;
  std::array<std::unique_ptr<PtyLine>, 3> lines_;
  std::int64_t start_utime_us_;
  std::int64_t now_us_ = 0;
  std::int64_t next_truth_us_ = 0;
  std::int64_t truth_seq_ = 0;
  std::int64_t worst_lag_us_ = 0;
  double distance_m_ = 0.0;
  double min_clearance_m_;
  Eigen::Vector3d last_position_;
};

}  // namespace nodmap::sim
