// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/program.hpp"

#include "common/node/clock.hpp"
#include "common/node/device_node.hpp"
#include "common/node/log.hpp"
#include "common/params/params.hpp"
#include "drivers/laser3d/node.hpp"

namespace nodmap::laser3d {
namespace {

serial::ReconnectingPort::Opener opener(const std::string& device, int baud) {
  return [&device, baud] { return serial::open_serial_port({device, baud, nullptr}); };
}

}  // namespace

int run_laser3d(int argc, char** argv) {
  Laser3dParams params;
  params::Table table(params);
  return node::run_device_node(
      argc, argv,
      {"nodmap-laser3d",
       "Drives the nodding 3D scanner, a SICK LMS2xx on a pitch servo: SCAN out."},
      table, nullptr, [&params](node::Context& context) {
        log::get().info("laser on {}, servo on {}", params.laser_device, params.servo_device);
        return std::make_unique<Laser3dNode>(
            context, params,
            Laser3dNode::Openers{.laser = opener(params.laser_device, params.laser_baud),
                                 .servo = opener(params.servo_device, params.servo_baud)},
            time::now_on_both_clocks);
      });
}

}  // namespace nodmap::laser3d
