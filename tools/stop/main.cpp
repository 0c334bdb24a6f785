// SPDX-License-Identifier: BSD-3-Clause
// nodmap-stop: stops the robot until it is released; with --go, releases it.
#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <string>

#include "common/bus/live_bus.hpp"
#include "common/node/clock.hpp"
#include "common/node/program.hpp"
#include "common/node/request.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap {
namespace {

using std::chrono::milliseconds;

/// Sent several times, in case one is lost or a base driver repeats an older STOP at that moment.
constexpr int kTimes = 3;
constexpr milliseconds kPause(300);

struct Arguments {
  bool is_go = false;
  node::RequestOptions request{.by = "nodmap-stop"};
};

void say(bus::LiveBus& bus, const Arguments& arguments) {
  stop_t message{};
  message.is_stopped = static_cast<std::int8_t>(!arguments.is_go);
  message.requested_by = arguments.request.by;
  for (int i = 0; i < kTimes; ++i) {
    message.utime = time::to_utime(time::SystemClock().now());
    message.stop_seq = i;
    bus.publish("STOP", message);
    const auto end = std::chrono::steady_clock::now() + kPause;
    while (std::chrono::steady_clock::now() < end) {
      bus.handle(std::chrono::duration_cast<milliseconds>(kPause));
    }
  }
}

int run(const Arguments& arguments, const std::string& lcm_url) {
  bus::LiveBus bus(lcm_url);
  if (arguments.is_go &&
      node::await_processes(bus, {"nodmap-kurt"}, arguments.request.wait_s).empty()) {
    std::cerr << "nodmap-stop: no nodmap-kurt within " << arguments.request.wait_s << " s\n";
    return 1;
  }
  say(bus, arguments);
  return bus.counts().not_published == 0 ? 0 : 1;
}

}  // namespace
}  // namespace nodmap

int main(int argc, char** argv) {
  using namespace nodmap;
  Arguments arguments;
  return node::run_program(
      argc, argv,
      {.name = "nodmap-stop",
       .summary = "Stops the robot until it is released; with --go, releases it.",
       .uses_lcm = true,
       .add_options =
           [&arguments](CLI::App& app) {
             app.add_flag("--go", arguments.is_go,
                          "Release the robot, after a STOP or a start of the base driver");
             node::add_request_options(app, arguments.request,
                                       "With --go: how long to wait for the base driver, seconds");
           },
       .run = [&arguments](const std::string& lcm_url) { return run(arguments, lcm_url); }});
}
