// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/device_node.hpp"

#include <poll.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "common/node/log.hpp"
#include "common/node/status.hpp"

namespace nodmap::node {
namespace {

constexpr time::Duration kShutdownTimeout = 500ms;

// Waits until a message or bytes of a device have arrived, or the node has something due. A signal
// also ends the wait.
void wait_for_work(int bus_handle, DeviceNode& node) {
  const time::Duration wait = node.wait();
  const timespec timeout{wait / 1s, wait % 1s / 1ns};
  const std::array<int, 2> devices = node.poll_handles();
  std::array<pollfd, 3> entries{
      {{bus_handle, POLLIN, 0}, {devices[0], POLLIN, 0}, {devices[1], POLLIN, 0}}};
  ::ppoll(entries.data(), entries.size(), &timeout, nullptr);
}

void shut_down(DeviceNode& node) {
  const time::SteadyTime end = time::steady_now() + kShutdownTimeout;
  node.shut_down();
  while (!node.is_shut_down() && time::steady_now() < end) {
    wait_for_work(-1, node);
    node.spin_once();
  }
  node.finish();
}

void run_loop(const ProgramInfo& info, const std::string& lcm_url,
              const DeviceNodeFactory& make_node) {
  bus::LiveBus bus(lcm_url);
  MessageCounts counts;
  Context context{bus, counts, {}};
  const time::SystemClock clock;
  const std::unique_ptr<DeviceNode> node = make_node(context);
  StatusReporter status(info.name, bus, counts, clock);
  log::get().info("listening on {}", bus.url());
  while (!stop_requested()) {
    wait_for_work(bus.poll_handle(), *node);
    bus.handle(0ms);
    node->spin_once();
    status.publish_if_due(*node);
  }
  shut_down(*node);
  log::get().info("ended: {}", node->metrics().dump());
}

}  // namespace

int run_device_node(int argc, char** argv, const ProgramInfo& info, params::Table& table,
                    const std::function<void()>& check, const DeviceNodeFactory& make_node) {
  return run_program(argc, argv,
                     {.name = info.name,
                      .summary = info.summary,
                      .params = &table,
                      .uses_lcm = true,
                      .outlives_its_readers = true,
                      .check = check,
                      .run = [&](const std::string& lcm_url) {
                        run_loop(info, lcm_url, make_node);
                        return 0;
                      }});
}

}  // namespace nodmap::node
