// SPDX-License-Identifier: BSD-3-Clause
// nodmap-save: asks 2D SLAM and 6D SLAM to write their maps now.
#include <CLI/CLI.hpp>
#include <string>

#include "common/bus/live_bus.hpp"
#include "common/node/clock.hpp"
#include "common/node/program.hpp"
#include "common/node/request.hpp"
#include "nodmap/save_request_t.hpp"

namespace nodmap::save {
namespace {

constexpr double kWaitS = 2.5;

int run(const std::string& requested_by, const std::string& lcm_url) {
  bus::LiveBus bus(lcm_url);
  save_request_t request{};
  request.utime = time::to_utime(time::SystemClock().now());
  request.requested_by = requested_by;
  bus.publish("SAVE_REQUEST", request);
  return node::report_request(bus, {"nodmap-slam2d", "nodmap-slam6d"}, kWaitS);
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
             app.add_option("--by", requested_by, "Name of the requester, for the log")
                 ->capture_default_str();
           },
       .run = [&requested_by](
                  const std::string& lcm_url) { return save::run(requested_by, lcm_url); }});
}
