// SPDX-License-Identifier: BSD-3-Clause
#include "common/node/request.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <chrono>
#include <iostream>
#include <memory>

#include "common/node/log.hpp"
#include "common/node/option_checks.hpp"
#include "common/node/program.hpp"
#include "nodmap/status_t.hpp"

namespace nodmap::node {
namespace {

// Those of the processes from which a STATUS was received in time.
std::set<std::string> await_processes(bus::LiveBus& bus, const std::set<std::string>& names,
                                      double wait_s) {
  // Shared with the subscription, which lasts as long as the bus.
  const auto running = std::make_shared<std::set<std::string>>();
  bus.subscribe<nodmap::status_t>("STATUS", [names, running](const nodmap::status_t& status) {
    if (names.contains(status.process_name)) {
      running->insert(status.process_name);
    }
  });
  (void)handle_until(bus, wait_s, [&] { return *running == names; });
  return *running;
}

}  // namespace

void add_request_options(CLI::App& app, RequestOptions& options, const std::string& wait_help) {
  app.add_option("--wait", options.wait_s, wait_help)
      ->check(in_range(0.0, 3600.0))
      ->capture_default_str();
  app.add_option("--by", options.by, "Name of the requester, for the log")->capture_default_str();
}

bool handle_until(bus::LiveBus& bus, double wait_s, const std::function<bool()>& is_done) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(wait_s);
  do {  // also with --wait 0: what has arrived is handled
    bus.handle(std::chrono::milliseconds(100));
    if (is_done()) {
      return true;
    }
  } while (!stop_requested() && std::chrono::steady_clock::now() < end);
  return false;
}

int report_request(bus::LiveBus& bus, const std::set<std::string>& names, double wait_s) {
  if (bus.counts().not_published > 0) {
    log::get().error("cannot send the request on {}", bus.url());
    return 1;
  }
  const std::set<std::string> running = await_processes(bus, names, wait_s);
  if (running.empty()) {
    log::get().error("nobody listens on {}: no {} runs there", bus.url(), fmt::join(names, " or "));
    return 1;
  }
  std::cout << fmt::format("asked {}\n", fmt::join(running, " and "));
  return 0;
}

}  // namespace nodmap::node
