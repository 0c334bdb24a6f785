// SPDX-License-Identifier: BSD-3-Clause
// nodmap-save: asks 2D SLAM and 6D SLAM to write their maps now.
#include <CLI/CLI.hpp>
#include <string>

#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "common/node/process_names.hpp"
#include "common/node/program.hpp"
#include "common/node/request.hpp"
#include "nodmap/save_request_t.hpp"

namespace nodmap {
namespace {

int run(const node::RequestOptions& options, const std::string& lcm_url) {
  bus::LiveBus bus(lcm_url);
  save_request_t request{};
  request.utime = time::to_utime(time::SystemClock().now());
  request.requested_by = options.by;
  bus.publish("SAVE_REQUEST", request);
  return node::report_request(bus, {node::kSlam2d, node::kSlam6d}, options.wait_s);
}

}  // namespace
}  // namespace nodmap

int main(int argc, char** argv) {
  using namespace nodmap;
  node::RequestOptions options{.by = "nodmap-save", .wait_s = 2.5};
  return node::run_program(
      argc, argv,
      {.name = "nodmap-save",
       .summary = "Asks 2D SLAM and 6D SLAM to write their maps now.",
       .uses_lcm = true,
       .add_options =
           [&options](CLI::App& app) {
             node::add_request_options(app, options, "How long to listen for SLAM, seconds");
           },
       .run = [&options](const std::string& lcm_url) { return run(options, lcm_url); }});
}
