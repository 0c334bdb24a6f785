// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/program.hpp"

#include "common/log/log.hpp"
#include "common/node/device_process.hpp"
#include "common/params/params.hpp"
#include "common/time/clock.hpp"
#include "drivers/kurt/node.hpp"

namespace nodmap::kurt {

int run_kurt(int argc, char** argv) {
  KurtParams params;
  params::Table table(params);
  const auto check = [&params] {
    return params.device.empty()
               ? std::string("device: is not set; name the serial port of the CAN adapter")
               : std::string();
  };
  return node::run_device_process(
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
