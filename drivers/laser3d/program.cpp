// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/laser3d/program.hpp"

#include <poll.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <nlohmann/json.hpp>

#include "common/bus/live_bus.hpp"
#include "common/log/log.hpp"
#include "common/node/command_line.hpp"
#include "common/node/status.hpp"
#include "common/node/stop_signal.hpp"
#include "common/params/params.hpp"
#include "common/time/clock.hpp"
#include "drivers/laser3d/node.hpp"

namespace nodmap::laser3d {
namespace {

constexpr const char* kName = "nodmap-laser3d";
constexpr std::int64_t kFarewellUs = 500'000;

Moment now_on_both_clocks() {
  using std::chrono::duration_cast;
  using std::chrono::microseconds;
  return {time::SystemClock().now_utime_us(),
          duration_cast<microseconds>(std::chrono::steady_clock::now().time_since_epoch()).count()};
}

/// Until a message or bytes have come, or the node wants to look after its time-outs.
void wait_for_work(int bus_handle, Laser3dNode& node) {
  const timespec wait{0, 1000 * Laser3dNode::kTurnUs};
  const std::array<int, 2> ports = node.poll_handles();
  std::array<pollfd, 3> entries{
      {{bus_handle, POLLIN, 0}, {ports[0], POLLIN, 0}, {ports[1], POLLIN, 0}}};
  ::ppoll(entries.data(), entries.size(), &wait, nullptr);
}

/// Gives the laser half a second to come to rest.
void end_in_order(Laser3dNode& node) {
  const std::int64_t end_us = now_on_both_clocks().steady_us + kFarewellUs;
  node.shut_down();
  while (!node.at_rest() && now_on_both_clocks().steady_us < end_us) {
    wait_for_work(-1, node);
    node.turn();
  }
}

void run_loop(const node::CommonOptions& options, const Laser3dParams& params) {
  bus::LiveBus bus(options.lcm_url);
  node::Tally tally;
  node::Context context{bus, tally, {}};
  const time::SystemClock clock;
  Laser3dNode node(
      context, params,
      {.laser =
           [&params] {
             return serial::open_serial_port({params.laser_device, params.laser_baud, nullptr});
           },
       .servo =
           [&params] {
             return serial::open_serial_port({params.servo_device, params.servo_baud, nullptr});
           }},
      now_on_both_clocks);
  node::StatusReporter status(kName, bus, tally, clock);
  log::get().info("listening on {}, laser on {}, servo on {}", bus.url(), params.laser_device,
                  params.servo_device);
  while (!node::stop_requested()) {
    wait_for_work(bus.poll_handle(), node);
    bus.handle(std::chrono::milliseconds(0));
    node.turn();
    status.publish_if_due(node);
  }
  end_in_order(node);
  log::get().info("ended: {}", node.figures().dump());
}

}  // namespace

int run_laser3d(int argc, char** argv) {
  node::CommonOptions options;
  Laser3dParams params;
  params::Table table(params);
  CLI::App app("Drives the nodding 3D scanner, a SICK LMS2xx on a pitch servo: SCAN out.", kName);
  node::add_common_options(app, options, table);
  if (const auto code = node::parse_command_line(app, argc, argv)) {
    return *code;
  }
  if (const auto code = node::apply_common_options(kName, options, table)) {
    return *code;
  }
  node::catch_stop_signals();
  try {
    run_loop(options, params);
  } catch (const std::exception& error) {
    log::get().error("{}", error.what());
    return 1;
  }
  return 0;
}

}  // namespace nodmap::laser3d
