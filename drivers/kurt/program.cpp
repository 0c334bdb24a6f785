// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/program.hpp"

#include "common/node/clock.hpp"
#include "common/node/device_node.hpp"
#include "common/node/log.hpp"
#include "common/node/program.hpp"
#include "common/params/params.hpp"
#include "drivers/kurt/node.hpp"

namespace nodmap::kurt {

int run_kurt(int argc, char** argv) {
  KurtParams params;
  params::Table table(params);
  const auto check = [&params] {
    if (params.device.empty()) {
      throw node::UsageError("device: is not set; name the serial port of the CAN adapter");
    }
  };
  return node::run_device_node(
      argc, argv,
      {"nodmap-kurt", "Drives the KURT2 base through an SLCAN adapter: DRIVE in, ODOMETRY out."},
      table, check, [&params](node::Context& context) {
        log::get().info("base on {}", params.device);
        return std::make_unique<KurtNode>(
            context, params,
            [&params] {
              return serial::open_serial_port({params.device, params.baud, nullptr});
            },
            time::now_on_both_clocks);
      });
}

}  // namespace nodmap::kurt
