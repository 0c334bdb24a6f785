// SPDX-License-Identifier: BSD-3-Clause
// For tests: a NavigatorNode on a bus in memory, and the messages that it receives.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "common/node/messages.hpp"
#include "modules/navigator/local_map/test/scanned_ground.hpp"
#include "modules/navigator/node.hpp"
#include "tests/support/memory_bus.hpp"

namespace nodmap::navigator::test {

class NavigatorNodeTest : public ::testing::Test {
 protected:
  enum Input { kOdometry, kMap, kCommand, kState };

  /// Drives by the obstacle map alone, which tick() delivers, without the local map. With it, it
  /// plans on the 2D map as well.
  explicit NavigatorNodeTest(bool use_local_map = false, const char* geofence = "")
      : node_{context_, params(use_local_map, geofence)} {}

  static NavigatorParams params(bool use_local_map, const char* geofence) {
    NavigatorParams params;
    params.local_map.use = use_local_map;
    params.planner.use_map = use_local_map;
    params.geofence = geofence;
    return params;
  }

  /// All further messages come from this sender.
  void send_as(const bus::Sender& sender) { bus_.set_origin({sender, {}, arrived_}); }

  void give_odometry(std::int64_t utime_us) {
    auto message = node::write_odometry(time::from_utime(utime_us), geometry::to_se3({x_, 0, 0}));
    message.odometry_seq = odometry_seq_++;
    bus_.deliver("ODOMETRY", message);
  }

  nodmap::egomap_t empty_map(std::int64_t utime_us) {
    nodmap::egomap_t map{};
    map.scan_seq = map_seq_++;
    map.utime = utime_us;
    map.bin_first_rad = -geometry::kPi;
    map.bin_step_rad = geometry::deg_to_rad(1);
    map.orientation[0] = 1.0;
    map.num_bins = 360;
    map.distance_m.assign(360, std::numeric_limits<float>::infinity());
    const std::vector<float> none(360, std::numeric_limits<float>::quiet_NaN());
    map.point_x_m = map.point_y_m = map.point_z_m = map.age_s = none;
    return map;
  }

  nodmap::pitch_command_t command(std::int64_t utime_us) {
    nodmap::pitch_command_t message{};
    message.utime = utime_us;
    message.command_seq = command_seq_++;
    message.pitch_min_rad = -0.4;
    message.pitch_max_rad = pitch_max_rad_;
    message.sweep_s = 0.3;
    message.max_forward_mps = 1.0;
    return message;
  }

  void give_command(std::int64_t utime_us, double max_forward_mps = 1.0) {
    nodmap::pitch_command_t message = command(utime_us);
    message.max_forward_mps = max_forward_mps;
    bus_.deliver("PITCH_COMMAND", message);
  }

  void give_state(std::int64_t utime_us, bool stalled = false) {
    nodmap::pitch_state_t message{};
    message.utime = utime_us;
    message.state_seq = state_seq_++;
    message.sweep_count = utime_us / 350'000;
    message.is_stalled = stalled;
    bus_.deliver("PITCH_STATE", message);
  }

  /// Delivers ten milliseconds of all inputs but the lost one.
  void tick(int lost = -1) {
    now_us_ += 10'000;
    arrived_ += 10ms;
    send_as(bus_.origin().sender);
    if (lost != kCommand) {
      give_command(now_us_, max_forward_mps_);
    }
    if (lost != kState) {
      give_state(now_us_);
    }
    if (lost != kOdometry) {
      give_odometry(now_us_);
    }
    if (lost != kMap) {
      auto map = empty_map(now_us_);
      map.position_m[0] = x_;
      bus_.deliver("OBSTACLE_MAP", map);
    }
  }

  void run(double duration_s, int lost = -1) {
    for (double t = 0.0; t < duration_s - 0.005; t += 0.01) {
      tick(lost);
    }
  }

  [[nodiscard]] nodmap::drive_t drive() const { return bus_.last<nodmap::drive_t>("DRIVE"); }
  [[nodiscard]] nodmap::navigation_t navigation() const {
    return bus_.last<nodmap::navigation_t>("NAVIGATION");
  }
  [[nodiscard]] bool halts() const {
    return navigation().behaviour == nodmap::navigation_t::HALT && drive().forward_mps == 0.0 &&
           drive().yaw_rate_rad_s == 0.0 && !navigation().reason.empty();
  }
  [[nodiscard]] bool drives() const { return drive().forward_mps > 0.5; }

  std::int64_t rejected(const std::string& cause) {
    const auto found = counts_.rejected().find(cause);
    return found == counts_.rejected().end() ? 0 : found->second;
  }

  nodmap::test::MemoryBus bus_;
  node::MessageCounts counts_;
  node::Context context_{bus_, counts_, {}};
  NavigatorNode node_;
  std::int64_t now_us_ = 1'000'000'000;
  time::SteadyTime arrived_{};  ///< the steady clock, which nobody sets
  std::int64_t odometry_seq_ = 0;
  std::int64_t map_seq_ = 0;
  std::int64_t command_seq_ = 0;
  std::int64_t state_seq_ = 0;
  double x_ = 0.0;
  double max_forward_mps_ = 1.0;  ///< the pitch controller's bound
  double pitch_max_rad_ = 0.1;    ///< the upper end of the sweep; the lower one is at -0.4
};

/// Drives by the local map as well.
class NavigatorNodeScans : public NavigatorNodeTest {
 protected:
  NavigatorNodeScans() : NavigatorNodeTest(true) {}

  /// Delivers a scan of flat ground, measured around the time of the next tick, then that tick.
  void tick_with_scan() { tick_with(scan_of({}, {}, geometry::deg_to_rad(-20.0))); }

  void tick_with(scan::Scan scan) {
    scan.stamp = time::from_utime(now_us_) + 10ms - scan.duration / 2;
    scan.seq = scan_seq_++;
    tick();
    bus_.deliver("SCAN", node::write_scan(scan));
  }

  std::int64_t scan_seq_ = 0;
};

}  // namespace nodmap::navigator::test
