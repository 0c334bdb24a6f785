// SPDX-License-Identifier: BSD-3-Clause
#include "common/geometry/clock.hpp"
#include "common/node/device_node.hpp"
#include "common/node/process_names.hpp"
#include "common/node/program.hpp"
#include "common/params/params.hpp"
#include "drivers/kurt/node.hpp"

int main(int argc, char** argv) {
  using namespace nodmap;  // NOLINT(google-build-using-namespace): a program of one page
  kurt::KurtParams params;
  params::Table table(params);
  return node::run_device_node(
      argc, argv,
      {node::kBaseDriver,
       "Drives the KURT2 base through an SLCAN adapter: DRIVE in, ODOMETRY out."},
      table, [&params] { kurt::check(params); },
      [&params](node::Context& context) {
        auto node = std::make_unique<kurt::KurtNode>(
            context, params, serial::port_opener(params.device, params.baud),
            time::now_on_both_clocks);
        node->refuse_former_releases();
        return node;
      });
}
