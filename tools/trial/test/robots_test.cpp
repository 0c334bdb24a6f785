// SPDX-License-Identifier: BSD-3-Clause
#include "tools/trial/robots.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/bus/loop_bus.hpp"
#include "common/node/messages.hpp"
#include "nodmap/scan_t.hpp"
#include "tests/support/data_dir.hpp"
#include "tools/trial/record.hpp"

namespace nodmap::trial {
namespace robots_test {

// The same body everywhere, as for KURT3D.
TEST(Robots, EveryPartIsMadeForTheJackal) {
  AllParams params;
  set_robot(Robot::kJackal, params);
  const sim::RobotModelParams& model = params.sim.model;
  EXPECT_EQ(model.body.length_m, 0.508);
  EXPECT_EQ(model.body.width_m, 0.430);
  EXPECT_EQ(model.drive.top_speed_mps, 2.0);
  for (const robot::RobotParams* robot :
       {&params.navigator.robot, &params.map_server.robot, &params.pitch_controller.robot}) {
    EXPECT_EQ(robot->body.length_m, model.body.length_m);
    EXPECT_EQ(robot->body.width_m, model.body.width_m);
    EXPECT_EQ(robot->mount.x_m, model.servo.mount_x_m);
    EXPECT_EQ(robot->mount.z_m, model.servo.mount_z_m);
  }
  EXPECT_EQ(params.kurt.wheels.axis_m, model.drive.axis_length_m);
  EXPECT_EQ(params.kurt.wheels.turning_adaptation, model.drive.turning_adaptation);
}

// A wall 3 m ahead of base's origin; the laser is 0.12 m ahead of it.
TEST(Robots, LevelScannerMeasures720BeamsOver270Degrees) {
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
    network.set_time(kStart.wall_at(now));
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

}  // namespace robots_test
}  // namespace nodmap::trial
