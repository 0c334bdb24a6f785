// SPDX-License-Identifier: BSD-3-Clause
// nodmap-explore: starts an exploration, which ends when everything has been seen and the robot is
// back; with --end, ends it now.
#include <CLI/CLI.hpp>
#include <iostream>
#include <string>

#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "common/node/process_names.hpp"
#include "common/node/program.hpp"
#include "common/node/request.hpp"
#include "nodmap/exploration_t.hpp"
#include "nodmap/explore_t.hpp"

namespace nodmap {
namespace {

constexpr time::Duration kRepeat = 1s;

struct Arguments {
  bool is_end = false;
  node::RequestOptions request{.by = "nodmap-explore"};
};

// Repeats the request until the explorer reports that it follows it, because messages sent before
// it listens are lost.
int run(const Arguments& arguments, const std::string& lcm_url) {
  bus::LiveBus bus(lcm_url);
  const bus::Latest<exploration_t> exploration(bus, "EXPLORATION");
  explore_t message{};
  message.is_active = static_cast<std::int8_t>(!arguments.is_end);
  message.requested_by = arguments.request.by;
  time::SteadyTime request_due = time::steady_now();
  const auto ask_if_due = [&] {
    if (!exploration.get()) {
      return false;
    }
    const std::int8_t state = exploration.get()->state;
    const bool explores = state == exploration_t::EXPLORING || state == exploration_t::RETURNING;
    const bool is_as_asked = explores != arguments.is_end;
    if (!is_as_asked && time::steady_now() >= request_due) {
      request_due = time::steady_now() + kRepeat;
      message.utime = time::to_utime(time::SystemClock().now());
      bus.publish("EXPLORE", message);
    }
    return is_as_asked;
  };
  if (node::handle_until(bus, arguments.request.wait_s, ask_if_due)) {
    return 0;
  }
  std::cerr << "nodmap-explore: "
            << (exploration.get() ? "the explorer does not follow the request"
                                  : std::string("no ") + node::kExplorer)
            << " within " << arguments.request.wait_s << " s\n";
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
       .summary = "Starts the exploration, which ends when everything has been seen and the robot "
                  "is back home; with --end, ends it.",
       .uses_lcm = true,
       .add_options =
           [&arguments](CLI::App& app) {
             app.add_flag("--end", arguments.is_end,
                          "End the exploration; the robot stays where it is");
             node::add_request_options(app, arguments.request,
                                       "How long to wait for the explorer, seconds");
           },
       .run = [&arguments](const std::string& lcm_url) { return run(arguments, lcm_url); }});
}
