// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bench/live/stop_metrics.hpp"
#include "common/bus/live_bus.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/truth_t.hpp"

namespace nodmap::bench {

/// Listens to TRUTH and STATUS: how the simulated robot really moves, and which processes complain
/// of what.
class RobotObserver {
 public:
  RobotObserver() : bus_("") {
    bus_.subscribe<nodmap::truth_t>("TRUTH", [this](const nodmap::truth_t& truth) {
      collisions_ = truth.collisions;
      motions_.push_back({time::from_utime(truth.utime), truth.position_m[0], truth.position_m[1],
                          truth.forward_mps, truth.yaw_rate_rad_s});
    });
    bus_.subscribe<nodmap::status_t>("STATUS", [this](const nodmap::status_t& status) {
      if (status.health != nodmap::status_t::OK) {
        complaints_.try_emplace(status.process_name, status.health_reason);
      }
    });
  }

  /// Listens until `done()`, or for `seconds`. Returns whether it was done.
  template <class Done>
  bool listen(double seconds, Done done) {
    using Clock = std::chrono::steady_clock;
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    while (Clock::now() < end) {
      bus_.handle(std::chrono::milliseconds(5));
      if (done()) {
        return true;
      }
    }
    return false;
  }
  void listen(double seconds) {
    listen(seconds, [] { return false; });
  }
  [[nodiscard]] bool driving(double at_least_mps) const {
    return !motions_.empty() && motions_.back().forward_mps > at_least_mps;
  }
  [[nodiscard]] const std::vector<Motion>& motions() const { return motions_; }
  [[nodiscard]] std::int64_t collisions() const { return collisions_; }
  /// For each process the first reason for which it was not OK, since the reasons were last taken.
  [[nodiscard]] const std::map<std::string, std::string>& complaints() const { return complaints_; }
  [[nodiscard]] std::map<std::string, std::string> take_complaints() {
    return std::exchange(complaints_, {});
  }

 private:
  bus::LiveBus bus_;
  std::vector<Motion> motions_;
  std::int64_t collisions_ = 0;
  std::map<std::string, std::string> complaints_;
};

}  // namespace nodmap::bench
