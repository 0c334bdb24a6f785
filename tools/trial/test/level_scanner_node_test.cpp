// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/level_scanner_node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/bus/loop_bus.hpp"
#include "common/node/messages.hpp"
#include "nodmap/scan_t.hpp"
#include "tests/support/data_dir.hpp"
#include "tools/trial/record.hpp"
#include "tools/trial/robots.hpp"

namespace nodmap::trial {
namespace level_scanner_node_test {

// A wall 3 m ahead of base's origin; the laser is 0.12 m ahead of it.
TEST(LevelScannerNode, Measures720BeamsOver270Degrees) {
  sim::World world;
  world.objects.push_back({sim::Box{{3.05, 0.0, 1.0}, {0.1, 40.0, 2.0}, 0.0}});
  AllParams params;
  set_robot(Robot::kJackal, params);
  params.sim.model.laser.range_sigma_m = 0.0;
  sim::RobotModel model(world, params.sim.model, 1);
  const test::TemporaryDir dir;
  bus::LoopNetwork network(dir.path() / "log", {});
  bus::LoopBus bus(network);
  bus::LoopBus listener(network);
  std::vector<scan::Scan> scans;
  listener.subscribe<nodmap::scan_t>("SCAN", [&scans](const nodmap::scan_t& message) {
    EXPECT_TRUE(node::read_scan(message, scans.emplace_back()));
  });
  node::MessageCounts counts;
  node::Context context{bus, counts, {}};
  LevelScannerNode scanner(context, params.navigator.robot.mount, model);
  for (time::SteadyTime now{}; now <= time::SteadyTime(2s); now += 1ms) {
    model.advance_to(now);
    network.set_time({kStart.wall_at(now), now});
    scanner.spin_once();
    network.deliver();
  }
  ASSERT_EQ(scans.size(), 41U);  // one second to boot, then 40 Hz
  const scan::Scan& scan = scans.back();
  ASSERT_EQ(scan.ranges_m.size(), 720U);
  EXPECT_NEAR(scan.angle_rad(719), geometry::deg_to_rad(135.0), 1e-12);
  EXPECT_EQ(scan.ranges_m[0], std::numeric_limits<float>::infinity());  // looks back
  for (const std::size_t beam : {300U, 360U, 450U}) {
    // The mean over an oblique spot of 0.25 degrees.
    EXPECT_NEAR(scan.ranges_m[beam], 2.88 / std::cos(scan.angle_rad(beam)), 1e-3) << beam;
  }
}

}  // namespace level_scanner_node_test
}  // namespace nodmap::trial
