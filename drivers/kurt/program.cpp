// SPDX-License-Identifier: BSD-3-Clause
#include "drivers/kurt/program.hpp"

#include <poll.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <iostream>

#include "common/bus/live_bus.hpp"
#include "common/log/log.hpp"
#include "common/node/command_line.hpp"
#include "common/node/status.hpp"
#include "common/node/stop_signal.hpp"
#include "common/params/params.hpp"
#include "common/time/clock.hpp"
#include "drivers/kurt/node.hpp"

namespace nodmap::kurt {
namespace {

constexpr const char* kName = "nodmap-kurt";

Moment now_on_both_clocks() {
  using std::chrono::duration_cast;
  using std::chrono::microseconds;
  return {time::SystemClock().now_utime_us(),
          duration_cast<microseconds>(std::chrono::steady_clock::now().time_since_epoch()).count()};
}

/// Until a message or bytes have come, or the node has to act by itself. A signal ends it, too.
void wait_for_work(bus::LiveBus& bus, KurtNode& node) {
  const std::int64_t wait_us = node.wait_us();
  const timespec wait{wait_us / 1'000'000, 1000 * (wait_us % 1'000'000)};
  std::array<pollfd, 2> entries{{{bus.poll_handle(), POLLIN, 0}, {node.poll_handle(), POLLIN, 0}}};
  ::ppoll(entries.data(), entries.size(), &wait, nullptr);
}

void run_loop(const node::CommonOptions& options, const KurtParams& params) {
  bus::LiveBus bus(options.lcm_url);
  node::Tally tally;
  node::Context context{bus, tally, {}};
  const time::SystemClock clock;
  KurtNode node(
      context, params,
      [&params] {
        return serial::open_serial_port({params.device, params.baud, nullptr});
      },
      now_on_both_clocks);
  node::StatusReporter status(kName, bus, tally, clock);
  log::get().info("listening on {}, base on {}", bus.url(), params.device);
  while (!node::stop_requested()) {
    wait_for_work(bus, node);
    bus.handle(std::chrono::milliseconds(0));
    node.turn();
    status.publish_if_due(node);
  }
  node.finish();
  log::get().info("stopped the motors, ended");
}

}  // namespace

int run_kurt(int argc, char** argv) {
  node::CommonOptions options;
  KurtParams params;
  params::Table table(params);
  CLI::App app("Drives the KURT2 base through an SLCAN adapter: DRIVE in, ODOMETRY out.", kName);
  node::add_common_options(app, options, table);
  if (const auto code = node::parse_command_line(app, argc, argv)) {
    return *code;
  }
  if (const auto code = node::apply_common_options(kName, options, table)) {
    return *code;
  }
  if (params.device.empty()) {
    std::cerr << kName << ": device: is not set; name the serial port of the CAN adapter\n";
    return 2;
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

}  // namespace nodmap::kurt
