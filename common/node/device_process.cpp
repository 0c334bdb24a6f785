// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/device_process.hpp"

#include <poll.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/bus/live_bus.hpp"
#include "common/log/log.hpp"
#include "common/node/command_line.hpp"
#include "common/node/status.hpp"
#include "common/node/stop_signal.hpp"
#include "common/time/clock.hpp"

namespace nodmap::node {
namespace {

constexpr std::int64_t kFarewellUs = 500'000;

/// Until a message or bytes have come, or the node has to act by itself. A signal ends it, too.
void wait_for_work(int bus_handle, DeviceNode& node) {
  const std::int64_t wait_us = node.wait_us();
  const timespec wait{wait_us / 1'000'000, 1000 * (wait_us % 1'000'000)};
  const std::array<int, 2> devices = node.poll_handles();
  std::array<pollfd, 3> entries{
      {{bus_handle, POLLIN, 0}, {devices[0], POLLIN, 0}, {devices[1], POLLIN, 0}}};
  ::ppoll(entries.data(), entries.size(), &wait, nullptr);
}

void end_in_order(DeviceNode& node) {
  const std::int64_t end_us = time::now_on_both_clocks().steady_us + kFarewellUs;
  node.shut_down();
  while (!node.at_rest() && time::now_on_both_clocks().steady_us < end_us) {
    wait_for_work(-1, node);
    node.turn();
  }
  node.finish();
}

void run_loop(const ProgramInfo& info, const CommonOptions& options,
              const DeviceNodeFactory& make_node) {
  bus::LiveBus bus(options.lcm_url);
  Tally tally;
  Context context{bus, tally, {}};
  const time::SystemClock clock;
  const std::unique_ptr<DeviceNode> node = make_node(context);
  StatusReporter status(info.name, bus, tally, clock);
  log::get().info("listening on {}", bus.url());
  while (!stop_requested()) {
    wait_for_work(bus.poll_handle(), *node);
    bus.handle(std::chrono::milliseconds(0));
    node->turn();
    status.publish_if_due(*node);
  }
  end_in_order(*node);
  log::get().info("ended: {}", node->figures().dump());
}

}  // namespace

int run_device_process(int argc, char** argv, const ProgramInfo& info, params::Table& table,
                       const std::function<std::string()>& check,
                       const DeviceNodeFactory& make_node) {
  CommonOptions options;
  CLI::App app(info.summary, info.name);
  add_common_options(app, options, table);
  if (const auto code = parse_command_line(app, argc, argv)) {
    return *code;
  }
  if (const auto code = apply_common_options(info.name, options, table)) {
    return *code;
  }
  if (const std::string error = check(); !error.empty()) {
    std::cerr << info.name << ": " << error << "\n";
    return 2;
  }
  catch_stop_signals();
  try {
    run_loop(info, options, make_node);
  } catch (const std::exception& error) {
    log::get().error("{}", error.what());
    return 1;
  }
  return 0;
}

}  // namespace nodmap::node
