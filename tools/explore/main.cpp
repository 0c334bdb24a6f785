// SPDX-License-Identifier: BSD-3-Clause
// nodmap-explore: the robot explores until it has seen all and is back; with --end, it no longer
// does.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <string>

#include "common/bus/live_bus.hpp"
#include "common/node/clock.hpp"
#include "common/node/program.hpp"
#include "nodmap/exploration_t.hpp"
#include "nodmap/explore_t.hpp"

namespace nodmap {
namespace {

using std::chrono::milliseconds;

struct Arguments {
  bool is_end = false;
  double wait_s = 10.0;
  std::string by = "nodmap-explore";
};

/// Asks until the explorer says that it does what it was asked for: what is said before it listens
/// is lost, and so may a message be.
int run(const Arguments& arguments, const std::string& lcm_url) {
  bus::LiveBus bus(lcm_url);
  const bus::Latest<exploration_t> exploration(bus, "EXPLORATION");
  explore_t message{};
  message.is_active = static_cast<std::int8_t>(!arguments.is_end);
  message.requested_by = arguments.by;
  const auto end =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(arguments.wait_s);
  while (!node::stop_requested() && std::chrono::steady_clock::now() < end) {
    bus.handle(milliseconds(100));
    if (!exploration.get()) {
      continue;
    }
    const std::int8_t state = exploration.get()->state;
    const bool explores = state == exploration_t::EXPLORING || state == exploration_t::RETURNING;
    if (explores != arguments.is_end) {
      return 0;
    }
    message.utime = time::to_utime(time::SystemClock().now());
    bus.publish("EXPLORE", message);
    bus.handle(milliseconds(1000));
  }
  std::cerr << "nodmap-explore: "
            << (exploration.get() ? "the explorer does not do it" : "no nodmap-explorer")
            << " within " << arguments.wait_s << " s\n";
  return 1;
}

}  // namespace
}  // namespace nodmap

int main(int argc, char** argv) {
  using namespace nodmap;
  Arguments arguments;
  return node::run_program(
      argc, argv,
      {.name = "nodmap-explore",
       .summary = "The robot explores until it has seen all and is back home; with --end, it no "
                  "longer does.",
       .uses_lcm = true,
       .add_options =
           [&arguments](CLI::App& app) {
             app.add_flag("--end", arguments.is_end,
                          "End the exploration; the robot stays where it is");
             app.add_option("--wait", arguments.wait_s,
                            "How long to wait for the explorer, seconds")
                 ->check(CLI::Range(0.0, 3600.0))
                 ->capture_default_str();
             app.add_option("--by", arguments.by, "Name of the requester, for the log")
                 ->capture_default_str();
           },
       .run = [&arguments](const std::string& lcm_url) { return run(arguments, lcm_url); }});
}
