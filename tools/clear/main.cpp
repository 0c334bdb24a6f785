// SPDX-License-Identifier: BSD-3-Clause
// nodmap-clear: asks 2D SLAM to forget what its map shows in a rectangle.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "common/bus/live_bus.hpp"
#include "common/geometry/clock.hpp"
#include "common/node/goal_sender.hpp"
#include "common/node/option_checks.hpp"
#include "common/node/process_names.hpp"
#include "common/node/program.hpp"
#include "common/node/request.hpp"
#include "nodmap/clear_request_t.hpp"

namespace nodmap {
namespace {

struct Arguments {
  std::vector<double> corners_m;  // x and y of one corner, x and y of the opposite one
  node::RequestOptions request{.by = "nodmap-clear", .wait_s = 2.5};
};

clear_request_t write_request(const Arguments& arguments) {
  clear_request_t request{};
  request.utime = time::to_utime(time::SystemClock().now());
  request.requested_by = arguments.request.by;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto [low_m, high_m] =
        std::minmax({arguments.corners_m.at(axis), arguments.corners_m.at(axis + 2)});
    request.low_m[axis] = low_m;
    request.high_m[axis] = high_m;
  }
  return request;
}

int run(const Arguments& arguments, const std::string& lcm_url) {
  bus::LiveBus bus(lcm_url);
  bus.publish("CLEAR_REQUEST", write_request(arguments));
  return node::report_request(bus, {node::kSlam2d}, arguments.request.wait_s);
}

}  // namespace
}  // namespace nodmap

int main(int argc, char** argv) {
  using namespace nodmap;
  Arguments arguments;
  return node::run_program(
      argc, argv,
      {.name = "nodmap-clear",
       .summary = "Asks 2D SLAM to forget what its map shows in a rectangle: the cells become "
                  "unknown until the robot sees the place again.",
       .uses_lcm = true,
       .add_options =
           [&arguments](CLI::App& app) {
             app.add_option("CORNERS", arguments.corners_m,
                            "Two opposite corners, X1 Y1 X2 Y2 in map, metres")
                 ->expected(4)
                 ->check(node::in_range(-node::kMaxCoordinateM, node::kMaxCoordinateM))
                 ->required();
             app.parse_complete_callback([&arguments] {
               const std::vector<double>& m = arguments.corners_m;
               const double area_m2 = (m.at(2) - m.at(0)) * (m.at(3) - m.at(1));
               if (!std::isfinite(area_m2) || area_m2 == 0.0) {
                 throw CLI::ValidationError("CORNERS", "a rectangle with an area is needed");
               }
             });
             node::add_request_options(app, arguments.request,
                                       "How long to listen for 2D SLAM, seconds");
           },
       .run = [&arguments](const std::string& lcm_url) { return run(arguments, lcm_url); }});
}
