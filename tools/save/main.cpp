// SPDX-License-Identifier: BSD-3-Clause
// nodmap-save: asks 2D SLAM and 6D SLAM to write their maps now.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <set>
#include <string>

#include "common/bus/live_bus.hpp"
#include "common/node/clock.hpp"
#include "common/node/log.hpp"
#include "common/node/program.hpp"
#include "nodmap/save_request_t.hpp"
#include "nodmap/status_t.hpp"

namespace nodmap::save {
namespace {

/// LCM gives no receipt: who listens is known by STATUS, which comes once a second.
constexpr std::chrono::milliseconds kPatience(2500);

/// The processes that write maps and have been heard, until all are or the patience is over.
std::set<std::string> listeners(bus::LiveBus& bus) {
  const std::set<std::string> mappers = {"nodmap-slam2d", "nodmap-slam6d"};
  std::set<std::string> heard;
  bus.subscribe<nodmap::status_t>("STATUS", [&](const nodmap::status_t& status) {
    if (mappers.contains(status.process_name)) {
      heard.insert(status.process_name);
    }
  });
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (heard != mappers && !node::stop_requested() && std::chrono::steady_clock::now() < end) {
    bus.handle(std::chrono::milliseconds(50));
  }
  return heard;
}

int run(const std::string& requested_by, const std::string& lcm_url) {
  bus::LiveBus bus(lcm_url);
  save_request_t request{};
  request.utime = time::to_utime(time::SystemClock().now());
  request.requested_by = requested_by;
  bus.publish("SAVE_REQUEST", request);
  if (bus.counts().not_published > 0) {
    log::get().error("the request could not be sent on {}", bus.url());
    return 1;
  }
  const std::set<std::string> heard = listeners(bus);
  if (heard.empty()) {
    log::get().error("nobody listens on {}: neither nodmap-slam2d nor nodmap-slam6d runs there",
                     bus.url());
    return 1;
  }
  std::string names;
  for (const std::string& name : heard) {
    names += (names.empty() ? "" : " and ") + name;
  }
  std::cout << "asked " << names << "\n";
  return 0;
}

}  // namespace
}  // namespace nodmap::save

int main(int argc, char** argv) {
  using namespace nodmap;
  std::string requested_by = "nodmap-save";
  return node::run_program(
      argc, argv,
      {.name = "nodmap-save",
       .summary = "Asks 2D SLAM and 6D SLAM to write their maps now.",
       .uses_lcm = true,
       .add_options =
           [&requested_by](CLI::App& app) {
             app.add_option("--by", requested_by, "Who asks, for the log")->capture_default_str();
           },
       .run = [&requested_by](
                  const std::string& lcm_url) { return save::run(requested_by, lcm_url); }});
}
