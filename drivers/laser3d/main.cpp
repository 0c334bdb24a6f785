// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/clock.hpp"
#include "common/node/device_node.hpp"
#include "common/node/program.hpp"
#include "common/params/params.hpp"
#include "drivers/laser3d/node.hpp"

int main(int argc, char** argv) {
  using namespace nodmap;  // NOLINT(google-build-using-namespace): a program of one page
  laser3d::Laser3dParams params;
  params::Table table(params);
  const auto check = [&params] {
    if (params.nod.fallback.min_rad > params.nod.fallback.max_rad) {
      throw node::UsageError("nod.default_min_deg: is above nod.default_max_deg");
    }
    if (params.laser.range_min_m >= params.laser.range_max_m) {
      throw node::UsageError("laser.range_min_m: is not below laser.range_max_m");
    }
    if (params.servo.maestro.us_per_deg == 0.0) {
      throw node::UsageError("servo.maestro.us_per_deg: must not be 0");
    }
    constexpr int kLastMaestroChannel = 23;  // of the largest Maestro
    if (params.servo.kind == laser3d::ServoKind::kMaestro &&
        params.servo.id > kLastMaestroChannel) {
      throw node::UsageError("servo.id: the last channel of a Maestro is 23");
    }
  };
  return node::run_device_node(
      argc, argv,
      {"nodmap-laser3d",
       "Drives the nodding 3D scanner, a SICK LMS2xx on a pitch servo: SCAN out."},
      table, check, [&params](node::Context& context) {
        return std::make_unique<laser3d::Laser3dNode>(
            context, params,
            laser3d::Laser3dNode::Openers{
                .laser = serial::port_opener(params.laser.device, params.laser.baud),
                .servo = serial::port_opener(params.servo.device, params.servo.baud)},
            time::now_on_both_clocks);
      });
}
