// SPDX-License-Identifier: BSD-3-Clause
#include "common/geometry/clock.hpp"
#include "common/node/device_node.hpp"
#include "common/node/program.hpp"
#include "common/params/params.hpp"
#include "drivers/laser3d/node.hpp"

int main(int argc, char** argv) {
  using namespace nodmap;  // NOLINT(google-build-using-namespace): a program of one page
  laser3d::Laser3dParams params;
  params::Table table(params);
  return node::run_device_node(
      argc, argv,
      {"nodmap-laser3d",
       "Drives the nodding 3D scanner, a SICK LMS2xx on a pitch servo: SCAN out."},
      table,
      [&params] {
        laser3d::check(params);
        laser3d::check_devices(params);
      },
      [&params](node::Context& context) {
        return std::make_unique<laser3d::Laser3dNode>(
            context, params,
            laser3d::Laser3dNode::Openers{
                .laser = serial::port_opener(params.laser.device, params.laser.baud),
                .servo = serial::port_opener(params.servo.device, params.servo.baud)},
            time::now_on_both_clocks);
      });
}
