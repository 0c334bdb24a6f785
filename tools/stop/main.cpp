// SPDX-License-Identifier: BSD-3-Clause
// nodmap-stop: stops the robot until it is released; with --go, releases it.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "common/bus/live_bus.hpp"
#include "common/node/clock.hpp"
#include "common/node/messages.hpp"
#include "common/node/program.hpp"
#include "common/node/request.hpp"
#include "common/node/stop_latch.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap {
namespace {

// Sent several times, in case one is lost or a base driver repeats an older STOP at that moment.
constexpr int kTimes = 3;
constexpr double kPauseS = 0.3;
// A base driver that is stopped says so by a STOP once a second.
constexpr double kListenS = 1.5;

struct Arguments {
  bool is_go = false;
  node::RequestOptions request{.by = "nodmap-stop"};
};

void send(bus::LiveBus& bus, const Arguments& arguments) {
  stop_t message{};
  // The same each time: a STOP of somebody else in between is newer than all of these.
  message.utime = time::to_utime(time::SystemClock().now());
  message.is_stopped = static_cast<std::int8_t>(!arguments.is_go);
  message.requested_by = arguments.request.by;
  for (int i = 0; i < kTimes && !node::stop_requested(); ++i) {
    message.stop_seq = i;
    bus.publish("STOP", message);
    (void)node::handle_until(bus, kPauseS, [] { return false; });
  }
}

// Waits for a base driver that is not FAILED: without its base it cannot drive, and when the base
// is back it may stop again. Returns false, with the reason on stderr, if there is none in time.
bool await_base_driver(bus::LiveBus& bus, double wait_s) {
  // Shared with the subscription, which lasts as long as the bus.
  const auto last = std::make_shared<std::optional<status_t>>();
  bus.subscribe<status_t>("STATUS", [last](const status_t& status) {
    if (status.process_name == node::kBaseDriver) {
      *last = status;
    }
  });
  const auto is_ready = [&last] { return *last && (*last)->health != status_t::FAILED; };
  if (node::handle_until(bus, wait_s, is_ready)) {
    return true;
  }
  if (*last) {
    std::cerr << "nodmap-stop: nodmap-kurt is FAILED: " << node::read_name((*last)->health_reason)
              << "\n";
  } else {
    std::cerr << "nodmap-stop: no nodmap-kurt within " << wait_s << " s\n";
  }
  return false;
}

int release(bus::LiveBus& bus, const Arguments& arguments) {
  if (!await_base_driver(bus, arguments.request.wait_s)) {
    return 1;
  }
  send(bus, arguments);
  if (bus.counts().not_published > 0) {
    return 1;
  }
  std::string by;  // what keeps it stopped: an alarm that lasts, or somebody else's newer STOP
  bus.subscribe<stop_t>("STOP", [&by](const stop_t& message) {
    if (node::is_confirmation(message)) {
      by = node::read_name(message.requested_by);
    }
  });
  if (node::handle_until(bus, kListenS, [&by] { return !by.empty(); })) {
    std::cerr << "nodmap-stop: the robot is still stopped, by " << by << "\n";
    return 1;
  }
  return 0;
}

int stop(bus::LiveBus& bus, const Arguments& arguments) {
  bool is_confirmed = false;
  bus.subscribe<stop_t>("STOP", [&is_confirmed](const stop_t& message) {
    is_confirmed |= node::is_confirmation(message);
  });
  send(bus, arguments);
  if (!node::handle_until(bus, arguments.request.wait_s, [&] { return is_confirmed; })) {
    std::cerr << "nodmap-stop: STOP was sent, but no nodmap-kurt has confirmed it within "
              << arguments.request.wait_s << " s\n";
    return 1;
  }
  return 0;
}

int run(const Arguments& arguments, const std::string& lcm_url) {
  bus::LiveBus bus(lcm_url);
  return arguments.is_go ? release(bus, arguments) : stop(bus, arguments);
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
                          "Release the robot: after a STOP, a start of the base driver, or the "
                          "return of its base");
             node::add_request_options(app, arguments.request,
                                       "How long to wait for the base driver, seconds");
           },
       .run = [&arguments](const std::string& lcm_url) { return run(arguments, lcm_url); }});
}
