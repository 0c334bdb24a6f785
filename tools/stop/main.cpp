// SPDX-License-Identifier: BSD-3-Clause
// nodmap-stop: stops the robot until it is released; with --go, releases it.
#include <CLI/CLI.hpp>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "common/node/messages.hpp"
#include "common/node/process_names.hpp"
#include "common/node/program.hpp"
#include "common/node/request.hpp"
#include "common/node/stop_sender.hpp"
#include "nodmap/status_t.hpp"
#include "nodmap/stop_t.hpp"

namespace nodmap {
namespace {

// A base driver that is stopped says so by a STOP once a second.
constexpr double kListenS = 1.5;
// Enough for all copies of a message, also on a busy machine.
constexpr double kSendS = 3.0;

struct Arguments {
  bool is_go = false;
  node::RequestOptions request{.by = "nodmap-stop"};
};

// Repeats what `sender` sends until `is_done()`. Returns false if that takes more than `wait_s`
// seconds, or this process is told to stop.
bool send_until(bus::LiveBus& bus, node::StopSender& sender, double wait_s,
                const std::function<bool()>& is_done) {
  return node::handle_until(bus, wait_s, [&] {
    sender.repeat_if_due(time::SystemClock().now());
    return is_done();
  });
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

int release(bus::LiveBus& bus, node::StopSender& sender, double wait_s) {
  if (!await_base_driver(bus, wait_s)) {
    return 1;
  }
  sender.release(time::SystemClock().now());
  if (!send_until(bus, sender, kSendS, [&] { return sender.is_sent(); }) ||
      bus.counts().not_published > 0) {
    std::cerr << "nodmap-stop: not every copy of the release could be sent; the robot may drive\n";
    return 1;
  }
  // By an alarm that lasts, or somebody else's newer STOP.
  const auto is_stopped = [&] { return sender.confirmed_by().has_value(); };
  if (node::handle_until(bus, kListenS, is_stopped)) {
    std::cerr << "nodmap-stop: the robot is still stopped, by " << *sender.confirmed_by() << "\n";
    return 1;
  }
  return 0;
}

int stop(bus::LiveBus& bus, node::StopSender& sender, double wait_s) {
  sender.stop(time::SystemClock().now());
  if (!send_until(bus, sender, kSendS, [&] { return sender.is_sent(); }) ||
      !send_until(bus, sender, wait_s, [&] { return sender.confirmed_by().has_value(); })) {
    std::cerr << "nodmap-stop: "
              << (bus.counts().not_published > 0 ? "STOP could not be sent every time, and"
                                                 : "STOP was sent, but")
              << " no nodmap-kurt has confirmed it within " << wait_s << " s\n";
    return 1;
  }
  return 0;
}

int run(const Arguments& arguments, const std::string& lcm_url) {
  bus::LiveBus bus(lcm_url);
  node::StopSender sender(bus, arguments.request.by);
  bus.subscribe<stop_t>("STOP", [&sender](const stop_t& message) { sender.take(message); });
  return (arguments.is_go ? release : stop)(bus, sender, arguments.request.wait_s);
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
